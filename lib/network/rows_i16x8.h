/* rows.h for blocks by row, where a processor makes eight products of 16 bits at a time and adds those that are
 * neighbours: in the words of SSE2 and of WebAssembly's SIMD.
 *
 *   vector         eight activations or weights, or four sums
 *   PRODUCTS(a, b) four sums of two products each
 *   LOW HIGH       the lower and the upper two sums of two vectors, in turn
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_I16X8_H
#define EDML_ROWS_I16X8_H

#ifdef __wasm_simd128__
#include <wasm_simd128.h>
typedef v128_t vector;
#define LOAD(p) wasm_v128_load(p)
#define LOAD_BYTES(p) wasm_i16x8_load8x8(p)
#define STORE(p, a) wasm_v128_store(p, a)
#define ZERO wasm_i32x4_splat(0)
#define ADD(a, b) wasm_i32x4_add(a, b)
#define PRODUCTS(a, b) wasm_i32x4_dot_i16x8(a, b)
#define LOW(a, b) wasm_i32x4_shuffle(a, b, 0, 4, 1, 5)
#define HIGH(a, b) wasm_i32x4_shuffle(a, b, 2, 6, 3, 7)
#else
#include <emmintrin.h>
typedef __m128i vector;
#define LOAD(p) _mm_loadu_si128((const __m128i *)(p))
#define TWICE(bytes) _mm_unpacklo_epi8(bytes, bytes) /* the upper one has the sign */
#define LOAD_BYTES(p) _mm_srai_epi16(TWICE(_mm_loadl_epi64((const __m128i *)(p))), 8)
#define STORE(p, a) _mm_storeu_si128((__m128i *)(p), a)
#define ZERO _mm_setzero_si128()
#define ADD(a, b) _mm_add_epi32(a, b)
#define PRODUCTS(a, b) _mm_madd_epi16(a, b)
#define LOW(a, b) _mm_unpacklo_epi32(a, b)
#define HIGH(a, b) _mm_unpackhi_epi32(a, b)
#endif

#ifdef EDML_BYTES
#define LOAD_WEIGHTS(p) LOAD_BYTES(p)
#else
#define LOAD_WEIGHTS(p) LOAD(p)
#endif

#include "rows_all_inputs.h"

enum { ROWS = EDML_ROWS };

/* Twice, first of rows 0 and 2 and of rows 1 and 3: the sums of the lanes of four rows. */
static EDML_INLINE vector fold(vector a, vector b) { return ADD(LOW(a, b), HIGH(a, b)); }

static EDML_INLINE void add_lanes(value sum[4], const vector s[4])
{
    STORE(sum, ADD(LOAD(sum), fold(fold(s[0], s[2]), fold(s[1], s[3]))));
}

static EDML_INLINE void add_blocks(value sum[ROWS], const activation *x, const weight *w, int inputs)
{
    vector s[ROWS];
#pragma GCC unroll 8
    for (int row = 0; row < ROWS; row++) s[row] = ZERO;
    for (const activation *const end = x + inputs; x < end; x += EDML_CHUNK, w += (int)ROWS * EDML_CHUNK) {
        const vector xs = LOAD(x);
#pragma GCC unroll 8
        for (int row = 0; row < ROWS; row++)
            s[row] = ADD(s[row], PRODUCTS(xs, LOAD_WEIGHTS(w + EDML_CHUNK * row)));
    }
    add_lanes(sum, s);
    add_lanes(sum + 4, s + 4);
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
