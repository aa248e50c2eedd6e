/* The network in the float pipeline: float ones as they are, quantised ones between conversions.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

#define ONE 16777216.0F /* of Q24 */

static int32_t to_q24(float value)
{
    return value < 127.0F ? (int32_t)(value * ONE + 0.5F) : INT32_C(127) << 24; /* value >= 0 */
}

void edml_net_f32(float distance[EDML_PAIRS], const float edm[EDML_PAIRS], const edml_model *model,
                  edml_work *work)
{
    if (model->predict_f32 != NULL) {
        model->predict_f32(distance, edm, model, work->use.layer);
        return;
    }
    int32_t *value = work->use.q24.edm; /* `edm` may be use.layer[0], which it does not overlap */
    for (int k = 0; k < EDML_PAIRS; k++) value[k] = to_q24(edm[k]);
    model->predict_q24(value, value, model, work->use.q24.layer);
    for (int k = 0; k < EDML_PAIRS; k++) distance[k] = (float)value[k] / ONE;
}
