/* The network's part of the lift, by `direct`.
 *
 * SPDX-License-Identifier: MIT
 */
#define MODEL edml_direct_w16
#include "network.h"
