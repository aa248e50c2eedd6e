/* The float pipeline with FConv for its network, which takes more memory.
 *
 * SPDX-License-Identifier: MIT
 */
#include "real_f32.h"

#include "net_float.inc"
#include "seen.inc"

void edml_net_fconv_f32(float distance[EDML_PAIRS], const float edm[EDML_PAIRS],
                        const edml_model *model, edml_fconv_work *work)
{
    if (!IS_FCONV(model)) {
        edml__fconv_refuse(distance, edm, model, work->lift.use.layer);
        return;
    }
    const edml_fconv *net = model->layers;
    if (net->predict_f32 != NULL) {
        net->predict_f32(distance, edm, net->layers, &work->maps.f32);
        return;
    }
    int32_t *value = work->lift.use.q24.edm; /* as in net_f32.c */
    to_q24(value, edm);
    net->predict_q24(value, value, net->layers, &work->maps.q7);
    from_q24(distance, value);
}

#define LIFT_BY_FCONV
#include "lift.inc"
