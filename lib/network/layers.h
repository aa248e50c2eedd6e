/* Layers of networks, as generated weight headers hold them.  Not part of the public interface.
 *
 * Rows of weights are grouped by EDML_ROWS; a group holds, input by input, the weights of its rows.  The
 * last group is filled up with zeros.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_LAYERS_H
#define EDML_LAYERS_H

#include <stdint.h>

enum {
    EDML_ROWS = 8,           /* rows of weights that lie side by side */
    EDML_MAX_UNITS = 192,    /* of a fully connected layer: two layers fit a lift's scratch */
    EDML_ACTIVATION = 32767, /* the largest activation of a quantised network */
    EDML_INPUT_SHIFT = 12,   /* a quantised network reads Q24 >> 12: Q12, within 8 */
    EDML_SOFTENING = 2458    /* Q12, 0.6: equivariant networks read d^2 / (d + softening) */
};

#define EDML_GROUPS(outputs) (((outputs) + EDML_ROWS - 1) / EDML_ROWS)

/* y = relu(W x + b) */
typedef struct {
    uint16_t inputs, outputs;
    const float *weight; /* [groups][inputs][EDML_ROWS] */
    const float *bias;   /* [groups * EDML_ROWS] */
} edml_dense_f32;

/* y = clamp(((W x + b) multiplier + 2^(shift - 1)) >> shift, 0, clamp), the product in 64 bits; the last
 * layer of an equivariant network has no ReLU, so that its y has the sign of W x + b.
 *   x  0 to EDML_ACTIVATION.  In an equivariant network: the sum or difference of two activations of up
 *      to half of that; in its first layer, -32768 to 32767
 * The exporter proves from the rows' weights and these bounds that no sum on the way to W x + b leaves 32
 * bits. */
typedef struct {
    uint16_t inputs, outputs;
    const int16_t *weight;            /* [groups][inputs][EDML_ROWS], EDML_ALIGN4 */
    const int32_t *bias, *multiplier; /* [groups * EDML_ROWS]; multiplier > 0 */
    uint8_t shift;                    /* 1 to 62 */
    int32_t clamp; /* of an activation; in the last layer, whose y is in metres, Q24: 3 m */
} edml_dense_w16;

typedef struct { /* the same with weights of 8 bits */
    uint16_t inputs, outputs;
    const int8_t *weight;
    const int32_t *bias, *multiplier;
    uint8_t shift;
    int32_t clamp;
} edml_dense_w8;

#endif
