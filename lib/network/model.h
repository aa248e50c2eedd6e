/* A model: what a generated weight header in gen/ fills in.  Not part of the public interface.
 *
 * A network is added by a kernel in a file of its own and a header in gen/; nothing here changes.  What a
 * lift does not know how to prepare (reads) or to use (gives) it refuses.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_MODEL_H
#define EDML_MODEL_H

#include "edmlift.h"
#include "edmlift/fixed.h"
#include "edmlift/stages.h"

#include "../number/compiler.h"
#include "layers.h"

/* Raised when the meaning of the generated data changes; a header of another format does not
 * compile. */
#define EDML_WEIGHTS_FORMAT 11

enum {
    EDML_READS_DISTANCES = 1, /* in the image.  Alone: [91], as edml_edm() has them */
    EDML_READS_BODY = 2       /* even and odd numbers of lift/inputs.h, of the distances as well */
};
enum {
    EDML_GIVES_DISTANCES = 1, /* [91] metres, in space: edml_mds() makes points of them */
    EDML_GIVES_POINTS = 2,    /* [14] metres, in the body's frame */
    EDML_GIVES_GATES = 4      /* [14] of edml_fuse() */
};

/* A setting in both arithmetics. */
typedef struct {
    float f32;
    int32_t q24;
} edml_number;

struct edml_model {
    const char *name;
    uint32_t checksum; /* FNV-1a over the bytes of each layer's arrays, in the order of its members */

    /* The network.  The model names its kernel, so that a program links only what its model needs.  A
     * float network has predict_f32, a quantised one predict_q, which the float lift runs between
     * conversions; the other is NULL.  `scratch` is a lift's work memory from its member `units` on.
     * `in` and `out` are outside of it, and may be the same; `out` has room for EDML_MAX_VALUES. */
    void (*predict_f32)(float *out, const float *in, const edml_model *model, void *scratch);
    void (*predict_q)(int32_t *out, const int32_t *in, const edml_model *model, void *scratch);
    uint32_t (*compute_checksum)(const edml_model *model);
    const void *layers;
    uint8_t layer_count;

    uint8_t reads, gives;                 /* EDML_READS_..., EDML_GIVES_... */
    uint8_t inputs, even_inputs, outputs; /* outputs: of an equivariant network, rows */

    /* Limits of what it was trained on, memory, and where joints are for it that were not seen. */
    uint8_t fewest_joints;
    uint16_t work_bytes, work_bytes_q; /* of edml_lift() and edml_lift_q(); 0: that cannot run it */
    const edml_imputation *imputation;

    /* What makes points of the distances that the network gives: a function of lift/scale.h, as far as the program
     * lifts in that arithmetic; else NULL. */
    edml_status (*scale_f32)(edml_work *work, const edml_model *model);
    edml_status (*scale_q)(edml_work_q *work, const edml_model *model);

    /* What was measured with it. */
    uint8_t objective; /* edml_objective */
    uint8_t refine_steps;
    edml_number mirror[5]; /* weights of arms, forearms, head, thighs, shins: lift/mirror.h */
    edml_number fusion[3]; /* share, without gates; misfit^2, 1 / distance: lift/fuse.h */
    edml_number mds_share; /* of the points of the MDS, in the mean with its own: lift/align.h */
};

enum { FUSION_SHARE, FUSION_SQUARE, FUSION_NEARNESS };

/* Runs the model's network on the work memory's of.network.io, in place; the caller has checked that it can.
 * predict_f32.c and predict_q.c. */
EDML_INTERNAL void edml__run_network(const edml_model *model, void *work);
EDML_INTERNAL void edml__run_network_q(const edml_model *model, void *work);

/* How many values the network gives: of an equivariant one full groups of rows, and their mirror rows. */
static inline int edml__output_values(const edml_model *model)
{
    if (!(model->reads & EDML_READS_BODY)) return model->outputs;
    return 2 * EDML_ROWS * EDML_GROUPS(model->outputs);
}

/* Does the lift know how to prepare what the network reads, and is what it gives a whole: distances of
 * distances; of the body's coordinates points and gates, and distances if it likes? */
static inline int edml__is_known(const edml_model *model)
{
    const int points = EDML_GIVES_POINTS | EDML_GIVES_GATES;
    if (model->reads == EDML_READS_DISTANCES) return model->gives == EDML_GIVES_DISTANCES;
    return (model->reads | EDML_READS_DISTANCES) == (EDML_READS_BODY | EDML_READS_DISTANCES) &&
           (model->gives | EDML_GIVES_DISTANCES) == (points | EDML_GIVES_DISTANCES);
}

/* Can a lift run the model in this work memory?  needed: model->work_bytes or _q. */
static inline edml_status edml__check_model(const edml_model *model, size_t needed, const void *work,
                                            size_t work_bytes)
{
    if (!EDML_IS_ALIGNED4(work)) return EDML_ERR_ARGUMENT;
    if (needed == 0 || !edml__is_known(model)) return EDML_ERR_MODEL;
    return work_bytes < needed ? EDML_ERR_WORK_TOO_SMALL : EDML_OK;
}

#endif
