/* FConn with left and right alike in whole numbers, weights of up to 8 bits.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

#define NAME(x) x##_q7
typedef int8_t weight;
typedef edml_dense_q7 dense_layer;

#include "twin_int.h"

#include "twin.inc"
