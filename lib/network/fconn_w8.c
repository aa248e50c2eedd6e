/* FConn in whole numbers, weights of up to 8 bits.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

#define NAME(x) x##_q7
typedef int8_t weight;
typedef edml_dense_q7 dense_layer;

#include "fconn_int.h"

#include "fconn.inc"
