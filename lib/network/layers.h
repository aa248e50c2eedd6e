/* Layers of networks, as generated weight headers hold them.  Not part of the public interface.
 *
 * Rows of weights are grouped by EDML_ROWS; a group holds, input by input, the weights of its rows.  The
 * last group is filled up with zeros.
 *
 * In integers, fully connected networks have blocks of EDML_ROWS rows and EDML_CHUNK inputs, each written
 * input by input: EDML_BLOCK of 16 bits, EDML_BYTES_BLOCK of 8.  A processor that multiplies many pairs of 16
 * bits at a time has each row of a block side by side, and one that multiplies two has the rows of each pair of
 * inputs side by side.  Inputs are filled up to whole blocks, in an equivariant network the even ones and the
 * odd ones.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_LAYERS_H
#define EDML_LAYERS_H

#include <stdint.h>

enum {
    EDML_ROWS = 8,           /* rows of weights that lie side by side; outputs are filled up to a multiple */
    EDML_CHUNK = 8,          /* inputs of a block */
    EDML_MAX_UNITS = 192,    /* of a fully connected layer: those of work.h */
    EDML_MAX_VALUES = 196,   /* of a network's inputs and outputs: those of work.h */
    EDML_ACTIVATION = 32767, /* the largest activation of a quantised network, ... */
    EDML_UNIT_BITS = 15,     /* ... of so many bits; */
    EDML_PAIRED_BITS = 14,   /* of an equivariant network, which adds two, of these */
    EDML_INPUT_SHIFT = 12,   /* a quantised network reads Q24 >> 12: Q12, within 8 */
    EDML_OUTPUT_SHIFT = 8,   /* and its last layer gives Q24 >> 8: metres, Q16 */
    EDML_SOFTENING = 2458    /* Q12, 0.6: equivariant networks read d^2 / (d + softening) */
};

#if defined(__ARM_FEATURE_MVE) || defined(__SSE2__) || defined(__wasm_simd128__)
#define EDML_BLOCKS_BY_ROW
#elif defined(__ARM_FEATURE_DSP) && defined(__thumb2__) && defined(__GNUC__) && !defined(__ARM_BIG_ENDIAN)
#define EDML_BLOCKS_BY_PAIR
#endif

#if defined(EDML_BLOCKS_BY_PAIR)
#define EDML_BLOCK(...) EDML_FOUR_PAIRS(EDML_PAIR_OF_INPUTS, __VA_ARGS__)
#define EDML_BYTES_BLOCK(...) EDML_FOUR_PAIRS(EDML_BYTES_OF_INPUTS, __VA_ARGS__)
#define EDML_PAIR_OF_INPUTS(a0, b0, c0, d0, e0, f0, g0, h0, a1, b1, c1, d1, e1, f1, g1, h1)                \
    a0, a1, b0, b1, c0, c1, d0, d1, e0, e1, f0, f1, g0, g1, h0, h1
#define EDML_BYTES_OF_INPUTS(a0, b0, c0, d0, e0, f0, g0, h0, a1, b1, c1, d1, e1, f1, g1, h1)               \
    a0, b0, a1, b1, c0, d0, c1, d1, e0, f0, e1, f1, g0, h0, g1, h1
#define EDML_FOUR_PAIRS(pair, a0, b0, c0, d0, e0, f0, g0, h0, a1, b1, c1, d1, e1, f1, g1, h1, a2, b2,      \
    c2, d2, e2, f2, g2, h2, a3, b3, c3, d3, e3, f3, g3, h3, a4, b4, c4, d4, e4, f4, g4, h4, a5, b5, c5,    \
    d5, e5, f5, g5, h5, a6, b6, c6, d6, e6, f6, g6, h6, a7, b7, c7, d7, e7, f7, g7, h7)                    \
    pair(a0, b0, c0, d0, e0, f0, g0, h0, a1, b1, c1, d1, e1, f1, g1, h1),                                  \
    pair(a2, b2, c2, d2, e2, f2, g2, h2, a3, b3, c3, d3, e3, f3, g3, h3),                                  \
    pair(a4, b4, c4, d4, e4, f4, g4, h4, a5, b5, c5, d5, e5, f5, g5, h5),                                  \
    pair(a6, b6, c6, d6, e6, f6, g6, h6, a7, b7, c7, d7, e7, f7, g7, h7)
#elif defined(EDML_BLOCKS_BY_ROW)
#define EDML_BYTES_BLOCK(...) EDML_BLOCK(__VA_ARGS__)
#define EDML_BLOCK(a0, b0, c0, d0, e0, f0, g0, h0, a1, b1, c1, d1, e1, f1, g1, h1, a2, b2, c2, d2, e2, f2, \
                   g2, h2, a3, b3, c3, d3, e3, f3, g3, h3, a4, b4, c4, d4, e4, f4, g4, h4, a5, b5, c5, d5, \
                   e5, f5, g5, h5, a6, b6, c6, d6, e6, f6, g6, h6, a7, b7, c7, d7, e7, f7, g7, h7)         \
    a0, a1, a2, a3, a4, a5, a6, a7, b0, b1, b2, b3, b4, b5, b6, b7, c0, c1, c2, c3, c4, c5, c6, c7, d0,    \
        d1, d2, d3, d4, d5, d6, d7, e0, e1, e2, e3, e4, e5, e6, e7, f0, f1, f2, f3, f4, f5, f6, f7, g0,    \
        g1, g2, g3, g4, g5, g6, g7, h0, h1, h2, h3, h4, h5, h6, h7
#else
#define EDML_BLOCK(...) __VA_ARGS__
#define EDML_BYTES_BLOCK(...) __VA_ARGS__
#endif

/* Where in a layer of integers the weight of a row and an input is; bytes: of a weight. */
static inline int edml__place(int row, int input, int inputs, int bytes)
{
    const int block = (row / EDML_ROWS * inputs + input / EDML_CHUNK * EDML_CHUNK) * EDML_ROWS;
    const int r = row % EDML_ROWS, i = input % EDML_CHUNK;
#if defined(EDML_BLOCKS_BY_PAIR)
    const int pair = block + i / 2 * 2 * EDML_ROWS;
    return bytes == 1 ? pair + r / 2 * 4 + i % 2 * 2 + r % 2 : pair + r * 2 + i % 2;
#elif defined(EDML_BLOCKS_BY_ROW)
    (void)bytes;
    return block + r * EDML_CHUNK + i;
#else
    (void)bytes;
    return block + i * EDML_ROWS + r;
#endif
}

#define EDML_GROUPS(outputs) (((outputs) + EDML_ROWS - 1) / EDML_ROWS)

/* y = relu(W x + b) */
typedef struct {
    uint16_t inputs, outputs;
    const float *weight; /* [groups][inputs][EDML_ROWS] */
    const float *bias;   /* [groups * EDML_ROWS] */
} edml_dense_f32;

/* y = clamp(((W x + b) multiplier + 2^(shift - 1)) >> shift, 0, clamp), the product in 64 bits; the last
 * layer of an equivariant network has no ReLU, and its y is within +-clamp.  It is computed as
 * ((W x + b) 2^(32 - shift) multiplier + 2^31) >> 32.
 *   x  0 to EDML_ACTIVATION.  In an equivariant network: the sum or difference of two activations of up
 *      to half of that; in its first layer, -32768 to 32767
 * The exporter proves from the rows' weights and these bounds that no sum on the way to W x + b leaves 32
 * bits, and that (W x + b) 2^(32 - shift) does not.  Only a last layer has another shift than 32. */
typedef struct {
    uint16_t inputs, outputs;
    const int16_t *weight;            /* [groups][inputs][EDML_ROWS], in blocks; EDML_ALIGN4 */
    const int32_t *bias, *multiplier; /* [groups * EDML_ROWS]; multiplier > 0 */
    uint8_t shift;                    /* 2 to 32 */
    int32_t clamp;                    /* the last layer: 3 m.  Others: what their kernel's bits hold */
} edml_dense_w16;

typedef struct { /* the same with weights of 8 bits */
    uint16_t inputs, outputs;
    const int8_t *weight;
    const int32_t *bias, *multiplier;
    uint8_t shift;
    int32_t clamp;
} edml_dense_w8;

#endif
