/* The network's part of the lift, by `distances`.
 *
 * SPDX-License-Identifier: MIT
 */
#define MODEL edml_distances_w16
#include "network.h"
