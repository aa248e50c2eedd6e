/* What a generated weight header in gen/ fills in.  Not part of the public interface.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_MODEL_H
#define EDML_MODEL_H

#include <stddef.h>

#include "edmlift.h"

/* Raised when the meaning of the generated data changes; a header of another format does not
 * compile. */
#define EDML_WEIGHTS_FORMAT 5

enum {
    EDML_LAYER_WIDEST = 192, /* units of a layer that fit edml_work */
    EDML_ROWS = 8,           /* rows of weights that lie side by side */
    EDML_ACTIVATION = 32767, /* the largest activation of a quantised network */
    EDML_FCONV_LAYERS = 5,
    EDML_EDM_SHIFT = 12,     /* its input is the EDM in Q24 shifted right by this: Q12, below 8 */
    EDML_SOFT = 2458,        /* of twin.inc, Q12 */
    EDML_MIDDLE = 14336      /* of twin_int.h, Q12 */
};

/* EDML_APART: a function that must not be inlined: its caller goes deeper once it is done, and what it
 * had on the stack would still be there.  EDML_IN_WORDS: weights that may be loaded a word at a time. */
#ifdef __GNUC__
#define EDML_APART __attribute__((noinline))
#define EDML_IN_WORDS __attribute__((aligned(4)))
#else
#define EDML_APART
#define EDML_IN_WORDS
#endif

/* A layer of a network.  Rows of weights are grouped by EDML_ROWS; a group holds, input by input,
 * the weights of its rows.  The last group is filled up with zeros. */

/* y = relu(W x + b) */
typedef struct {
    uint16_t inputs, outputs;
    const float *weight; /* [groups][inputs][EDML_ROWS] */
    const float *bias;   /* [groups * EDML_ROWS] */
} edml_dense_f32;

/* In whole numbers: y = ((W x + b) factor + 2^(shift - 1)) >> shift, limited to 0 to `most`, the
 * product in 64 bits.  0 <= x <= EDML_ACTIVATION; where left and right are alike, x are sums and
 * differences of two activations of up to half of that, and in the first layer of two inputs of -14336 to
 * 16145.  The exporter proves, by the rows' weights and these bounds, that no sum on the way to W x + b
 * leaves 32 bits. */
typedef struct {
    uint16_t inputs, outputs;
    const int16_t *weight; /* [groups][inputs][EDML_ROWS], EDML_IN_WORDS */
    const int32_t *bias, *factor; /* [groups * EDML_ROWS]; factor > 0 */
    uint8_t shift; /* 1 to 62 */
    int32_t most; /* of an activation; in the last layer, whose y is in metres, Q24: 3 m */
} edml_dense_q15;

typedef struct { /* the same with weights of 8 bits */
    uint16_t inputs, outputs;
    const int8_t *weight;
    const int32_t *bias, *factor;
    uint8_t shift;
    int32_t most;
} edml_dense_q7;

/* A setting in the arithmetic of both pipelines. */
typedef struct {
    float f32;
    int32_t q24;
} edml_number;

struct edml_model {
    const char *name;
    uint32_t checksum; /* FNV-1a over the bytes of each layer's arrays, in the order of its members */

    /* The network: its kernel is named here, so that a program links only what its model needs.
     * Float networks have predict_f32, quantised ones predict_q24; the other is NULL.  An FConv has no
     * layers of this kind: layer_count is 0, `layers` an edml_fconv, predict_f32 refuses. */
    void (*predict_f32)(float distance[EDML_PAIRS], const float edm[EDML_PAIRS],
                        const edml_model *model, float layer[2][EDML_LAYER_WIDEST]);
    void (*predict_q24)(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                        const edml_model *model, int32_t layer[2][EDML_LAYER_WIDEST]);
    uint32_t (*hash)(const edml_model *model);
    const void *layers;
    uint8_t layer_count;

    /* Limits of what it was trained on, and what joints that are not seen are for it. */
    uint8_t fewest_joints;
    edml_number widest; /* largest ratio of the width to the height of the seen joints */
    const edml_completion *completion; /* of edml_edm_f32() */

    /* What was measured with it. */
    uint8_t objective; /* edml_objective */
    uint8_t refine_steps;
    edml_number mirror[5]; /* weights of arms, forearms, head, thighs, shins: see mirror.inc */
    edml_number blend[3];  /* share misfit^2, misfit^2, 1 / distance: see blend.inc */
};

/* The network of an FConv model; one kernel is NULL.  `layers`: EDML_FCONV_LAYERS of edml_dense_f32 or
 * _q7, two convolutions, two transposed ones, and 1x1.  The inputs of the first four are windows of
 * [7][7][channels], in the order that fconv.inc has; up to EDML_CHANNELS outputs, a multiple of
 * EDML_ROWS.  In whole numbers the sums of the last stay within +-2^30, for it scales those of two. */
typedef struct {
    void (*predict_f32)(float distance[EDML_PAIRS], const float edm[EDML_PAIRS],
                        const void *layers, edml_fconv_maps_f32 *maps);
    void (*predict_q24)(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                        const void *layers, edml_fconv_maps_q7 *maps);
    const void *layers;
} edml_fconv;

#define IS_FCONV(model) ((model)->layer_count == 0)

/* FConn: fconn.inc in the arithmetic of fconn_f32.c, fconn_q15.c and fconn_q7.c. */
void edml__fconn_f32(float distance[EDML_PAIRS], const float edm[EDML_PAIRS],
                     const edml_model *model, float layer[2][EDML_LAYER_WIDEST]);
void edml__fconn_q15(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                     const edml_model *model, int32_t layer[2][EDML_LAYER_WIDEST]);
void edml__fconn_q7(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                    const edml_model *model, int32_t layer[2][EDML_LAYER_WIDEST]);
uint32_t edml__fconn_hash_f32(const edml_model *model);
uint32_t edml__fconn_hash_q15(const edml_model *model);
uint32_t edml__fconn_hash_q7(const edml_model *model);

/* FConn with left and right alike: twin.inc.  Layers of n outputs are 2n units, a multiple of EDML_ROWS
 * but in the last, whose n is 49; their inputs are those of the EDM or the 2n of the layer before. */
void edml__twin_f32(float distance[EDML_PAIRS], const float edm[EDML_PAIRS],
                    const edml_model *model, float layer[2][EDML_LAYER_WIDEST]);
void edml__twin_q15(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                    const edml_model *model, int32_t layer[2][EDML_LAYER_WIDEST]);
void edml__twin_q7(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                   const edml_model *model, int32_t layer[2][EDML_LAYER_WIDEST]);
uint32_t edml__twin_hash_f32(const edml_model *model);
uint32_t edml__twin_hash_q15(const edml_model *model);
uint32_t edml__twin_hash_q7(const edml_model *model);

/* FConv: fconv.inc in the arithmetic of fconv_f32.c and fconv_q7.c.  edml__fconv_refuse() is what its
 * models have for predict_f32: all distances are NaN. */
void edml__fconv_f32(float distance[EDML_PAIRS], const float edm[EDML_PAIRS], const void *layers,
                     edml_fconv_maps_f32 *maps);
void edml__fconv_q7(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                    const void *layers, edml_fconv_maps_q7 *maps);
uint32_t edml__fconv_hash_f32(const edml_model *model);
uint32_t edml__fconv_hash_q7(const edml_model *model);
void edml__fconv_refuse(float distance[EDML_PAIRS], const float edm[EDML_PAIRS],
                        const edml_model *model, float layer[2][EDML_LAYER_WIDEST]);

#endif
