/* q24_by_value.h by a Cortex-M with Helium (MVE): four values at a time.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_Q24_MVE_H
#define EDML_Q24_MVE_H

#include <arm_mve.h>

static void to_q24(int32_t *out, const float *in, int count)
{
    for (int k = 0; k < count; k += 4) vstrwq_s32(out + k, vcvtq_n_s32_f32(vldrwq_f32(in + k), 24));
}

static void from_q24(float *out, const int32_t *in, int count)
{
    for (int k = 0; k < count; k += 4) vstrwq_f32(out + k, vcvtq_n_f32_s32(vldrwq_s32(in + k), 24));
}

#endif
