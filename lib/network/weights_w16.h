/* Networks in integers, with weights of up to 16 bits.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_WEIGHTS_H
#define EDML_WEIGHTS_H

#include "model.h"

#define WEIGHTS(name) name##_w16
typedef int16_t weight;
typedef edml_dense_w16 dense_layer;

#include "weights_integer.h"

#endif
