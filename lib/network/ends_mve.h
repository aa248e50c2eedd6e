/* ends_by_value.h for integers, by a Cortex-M with Helium (MVE): four values at a time.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ENDS_MVE_H
#define EDML_ENDS_MVE_H

#include "weights_integer.h"

#include <arm_mve.h>

#include "rows.h"

static int read_inputs(activation *x, const value *in, int inputs)
{
    const int filled = (inputs + CHUNK - 1) / CHUNK * CHUNK;
    if (filled > 0) vstrhq_s16(x + filled - CHUNK, vdupq_n_s16(0));
    for (int k = 0; k < inputs; k += 4) { /* as signed_input() */
        const int32x4_t numbers = vldrwq_z_s32(in + k, vctp32q((uint32_t)(inputs - k)));
        const int16x8_t read = vqmovnbq_s32(vdupq_n_s16(0), vrshrq_n_s32(numbers, EDML_INPUT_SHIFT));
        vstrhq_s32(x + k, vreinterpretq_s32_s16(read));
    }
    return filled;
}

/* As signed_output(). */
static EDML_INLINE int32x4_t signed_outputs(int32x4_t sums, int32x4_t multipliers, const dense_layer *layer)
{
    const int32x4_t most = vdupq_n_s32(layer->clamp), least = vdupq_n_s32(-layer->clamp);
    const int32x4_t scaled = vrmulhq_s32(vshlq_r_s32(sums, 32 - layer->shift), multipliers);
    return vshlq_n_s32(vmaxq_s32(vminq_s32(scaled, most), least), EDML_OUTPUT_SHIFT);
}

static EDML_NOINLINE void give_rows(value *out, value sum[2][ROWS], const dense_layer *last, int row,
                                    int rows, int count)
{
    const int32_t *const multiplier = last->multiplier + row;
    for (int k = 0; k < rows; k += 4) {
        const int32x4_t even = vldrwq_s32(&sum[0][k]), odd = vldrwq_s32(&sum[1][k]);
        const int32x4_t multipliers = vldrwq_s32(multiplier + k);
        vstrwq_s32(out + k, signed_outputs(vaddq_s32(even, odd), multipliers, last));
        vstrwq_s32(out + count + k, signed_outputs(vsubq_s32(even, odd), multipliers, last));
    }
}

#endif
