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
#define EDML_WEIGHTS_FORMAT 6

enum { EDML_READS_DISTANCES = 1 }; /* [91] normalised, in the image: edml_edm() */
enum { EDML_GIVES_DISTANCES = 1 }; /* [91] metres, in space: edml_mds() makes points of them */

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
     * conversions; the other is NULL.  `scratch` is a lift's work memory from its member `scratch` on.
     * `in` may be its layer[0].  `in` and `out` may be the same: its integer.edm, or outside of it. */
    void (*predict_f32)(float *out, const float *in, const edml_model *model, void *scratch);
    void (*predict_q)(int32_t *out, const int32_t *in, const edml_model *model, void *scratch);
    uint32_t (*compute_checksum)(const edml_model *model);
    const void *layers;
    uint8_t layer_count;

    uint8_t reads, gives; /* EDML_READS_..., EDML_GIVES_... */

    /* Limits of what it was trained on, memory, and where joints are for it that were not seen. */
    uint8_t fewest_joints;
    uint16_t work_bytes, work_bytes_q; /* of edml_lift() and edml_lift_q(); 0: that cannot run it */
    edml_number max_aspect;            /* of the width to the height of the seen joints */
    const edml_imputation *imputation;

    /* What was measured with it. */
    uint8_t objective; /* edml_objective */
    uint8_t refine_steps;
    edml_number mirror[5]; /* weights of arms, forearms, head, thighs, shins: lift/mirror.h */
    edml_number fusion[3]; /* weight misfit^2, misfit^2, 1 / distance: lift/fuse.h */
};

/* Runs the model's network; the caller has checked that it can.  predict_f32.c and predict_q.c. */
EDML_INTERNAL void edml__run_network(float *out, const float *in, const edml_model *model, void *work);
EDML_INTERNAL void edml__run_network_q(int32_t *out, const int32_t *in, const edml_model *model,
                                       void *work);

/* Can a lift run the model in this work memory?  needed: model->work_bytes or _q. */
static inline edml_status edml__check_model(const edml_model *model, size_t needed, const void *work,
                                            size_t work_bytes)
{
    if (!EDML_IS_ALIGNED4(work)) return EDML_ERR_ARGUMENT;
    if (needed == 0 || model->reads != EDML_READS_DISTANCES || model->gives != EDML_GIVES_DISTANCES)
        return EDML_ERR_MODEL;
    return work_bytes < needed ? EDML_ERR_WORK_TOO_SMALL : EDML_OK;
}

#endif
