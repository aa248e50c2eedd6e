/* Values from float to Q24 and back, in portable C.  `out` is where `in` is, and both have room for a multiple of four.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_Q24_BY_VALUE_H
#define EDML_Q24_BY_VALUE_H

#include <stdint.h>

#define ONE_Q24 16777216.0F

/* Towards zero; |in| < 128. */
static void to_q24(int32_t *out, const float *in, int count)
{
    for (int k = 0; k < count; k++) out[k] = (int32_t)(in[k] * ONE_Q24);
}

static void from_q24(float *out, const int32_t *in, int count)
{
    for (int k = 0; k < count; k++) out[k] = (float)in[k] / ONE_Q24;
}

#endif
