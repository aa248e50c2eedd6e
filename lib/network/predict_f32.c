/* The network in the float lift: float ones as they are, quantised ones between conversions.
 *
 * SPDX-License-Identifier: MIT
 */
#include "../number/real_f32.h"
#include "model.h"

#define ONE_Q24 16777216.0F

static void to_q24(int32_t out[EDML_PAIRS], const float in[EDML_PAIRS]) /* in >= 0 */
{
    for (int k = 0; k < EDML_PAIRS; k++)
        out[k] = in[k] < 127.0F ? (int32_t)(in[k] * ONE_Q24 + 0.5F) : INT32_C(127) << 24;
}

static void from_q24(float out[EDML_PAIRS], const int32_t in[EDML_PAIRS])
{
    for (int k = 0; k < EDML_PAIRS; k++) out[k] = (float)in[k] / ONE_Q24;
}

void edml__run_network(float *out, const float *in, const edml_model *model, void *memory)
{
    edml_work *const work = memory;
    if (model->predict_f32 != NULL) {
        model->predict_f32(out, in, model, &work->scratch);
        return;
    }
    /* `in` may be scratch.layer[0], which these do not overlap */
    int32_t *integers = work->scratch.integer.edm;
    to_q24(integers, in);
    model->predict_q(integers, integers, model, &work->scratch);
    from_q24(out, integers);
}

edml_status edml_predict(float distance[EDML_PAIRS], const float edm[EDML_PAIRS], const edml_model *model,
                         void *work, size_t work_bytes)
{
    if (distance == NULL || edm == NULL || model == NULL || work == NULL) return EDML_ERR_ARGUMENT;
    const edml_status status = edml__check_model(model, model->work_bytes, work, work_bytes);
    if (status == EDML_OK) edml__run_network(distance, edm, model, work);
    return status;
}
