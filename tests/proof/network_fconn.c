/* The network's part of the lift, by `fconn`.
 *
 * SPDX-License-Identifier: MIT
 */
#define MODEL edml_fconn_w16
#include "network.h"
