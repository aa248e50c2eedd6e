/* Networks in integers, with weights of up to 8 bits.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_WEIGHTS_H
#define EDML_WEIGHTS_H

#include "model.h"

#define WEIGHTS(name) name##_w8
#define EDML_BYTES
typedef int8_t weight;
typedef edml_dense_w8 dense_layer;

#include "weights_integer.h"

#endif
