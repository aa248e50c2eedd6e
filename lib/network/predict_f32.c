/* The network in the float pipeline: float ones as they are, quantised ones between conversions.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

#include "net_float.inc"

void edml_net_f32(float distance[EDML_PAIRS], const float edm[EDML_PAIRS], const edml_model *model,
                  edml_work *work)
{
    if (model->predict_f32 != NULL) {
        model->predict_f32(distance, edm, model, work->use.layer);
        return;
    }
    int32_t *value = work->use.q24.edm; /* `edm` may be use.layer[0], which it does not overlap */
    to_q24(value, edm);
    model->predict_q24(value, value, model, work->use.q24.layer);
    from_q24(distance, value);
}
