/* What a generated weight header in gen/ fills in.  Not part of the public interface.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_MODEL_H
#define EDML_MODEL_H

#include "edmlift.h"

/* Raised when the meaning of the generated data changes; a header of another format does not
 * compile. */
#define EDML_WEIGHTS_FORMAT 1

enum {
    EDML_LAYER_WIDEST = 128, /* units of a layer that fit edml_work */
    EDML_ROWS = 8            /* rows of weights that lie side by side */
};

/* y = relu(W x + b).  Rows are grouped by EDML_ROWS; a group holds, input by input, the weights
 * of its rows.  The last group is filled up with zeros. */
typedef struct {
    uint16_t inputs, outputs;
    const float *weight; /* [groups][inputs][EDML_ROWS] */
    const float *bias;   /* [groups * EDML_ROWS] */
} edml_dense_f32;

struct edml_model {
    const char *name;
    uint32_t checksum; /* FNV-1a over the bytes of weights and biases, layer by layer */

    /* The network: the kernel is named here, so that a program links only what its model needs. */
    void (*predict)(float *distance, const float *edm, const edml_model *model, edml_work *work);
    uint32_t (*hash)(const edml_model *model);
    const void *layers;
    uint8_t layer_count;

    /* Limits of what it was trained on. */
    uint8_t fewest_joints;
    float widest; /* largest ratio of the width to the height of the seen joints */

    /* What was measured with it. */
    uint8_t objective; /* edml_objective */
    uint8_t refine_steps;
    float mirror[5]; /* weights of arms, forearms, head, thighs, shins: see mirror.inc */
};

/* FConn in float32, fconn_f32.c. */
void edml__fconn_f32(float *distance, const float *edm, const edml_model *model, edml_work *work);
uint32_t edml__fconn_hash_f32(const edml_model *model);

#endif
