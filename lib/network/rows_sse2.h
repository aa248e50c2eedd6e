/* rows.h for blocks by row in the words of SSE2: eight products at a time.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_SSE2_H
#define EDML_ROWS_SSE2_H

#include <emmintrin.h>

#include "rows_all_inputs.h"

enum { ROWS = EDML_ROWS };
#define SLOT(k) (k)
#define WEIGHTS_OF(layer, row) ((layer)->weight + (row) * (layer)->inputs)

static EDML_INLINE __m128i load_weights(const weight *w)
{
#ifdef EDML_BYTES
    const __m128i bytes = _mm_loadl_epi64((const __m128i *)w);
    return _mm_srai_epi16(_mm_unpacklo_epi8(bytes, bytes), 8); /* the sign is in the upper one */
#else
    return _mm_loadu_si128((const __m128i *)w);
#endif
}

/* The sums of the lanes of four numbers. */
static EDML_INLINE __m128i sum_of_lanes(const __m128i s[4])
{
    const __m128i a = _mm_add_epi32(_mm_unpacklo_epi32(s[0], s[1]), _mm_unpackhi_epi32(s[0], s[1]));
    const __m128i b = _mm_add_epi32(_mm_unpacklo_epi32(s[2], s[3]), _mm_unpackhi_epi32(s[2], s[3]));
    return _mm_add_epi32(_mm_unpacklo_epi64(a, b), _mm_unpackhi_epi64(a, b));
}

static EDML_INLINE void add_blocks(value sum[ROWS], const activation *x, const weight *w, int inputs)
{
    __m128i s[ROWS];
#pragma GCC unroll 8
    for (int row = 0; row < ROWS; row++) s[row] = _mm_setzero_si128();
    for (const activation *const end = x + inputs; x < end; x += EDML_CHUNK, w += ROWS * EDML_CHUNK) {
        const __m128i xs = _mm_loadu_si128((const __m128i *)x);
#pragma GCC unroll 8
        for (int row = 0; row < ROWS; row++)
            s[row] = _mm_add_epi32(s[row], _mm_madd_epi16(xs, load_weights(w + EDML_CHUNK * row)));
    }
    __m128i *const out = (__m128i *)sum;
    _mm_storeu_si128(out, _mm_add_epi32(_mm_loadu_si128(out), sum_of_lanes(s)));
    _mm_storeu_si128(out + 1, _mm_add_epi32(_mm_loadu_si128(out + 1), sum_of_lanes(s + 4)));
}

static void sum_rows(value sum[2][ROWS], const layer_inputs *in, const weight *w, const value *bias,
                     int rows)
{
    (void)rows;
    for (int row = 0; row < ROWS; row++) {
        sum[0][row] = bias[row];
        sum[1][row] = 0;
    }
    add_blocks(sum[0], in->x, w, in->even);
    add_blocks(sum[1], in->x + in->even, w + ROWS * in->even, in->odd);
}

#endif
