/* The network in the fixed-point lift.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

void edml__run_network_q(int32_t *out, const int32_t *in, const edml_model *model, void *memory)
{
    edml_work_q *const work = memory;
    model->predict_q(out, in, model, &work->scratch);
}

edml_status edml_predict_q(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                           const edml_model *model, void *work, size_t work_bytes)
{
    if (distance == NULL || edm == NULL || model == NULL || work == NULL) return EDML_ERR_ARGUMENT;
    const edml_status status = edml__check_model(model, model->work_bytes_q, work, work_bytes);
    if (status == EDML_OK) edml__run_network_q(distance, edm, model, work);
    return status;
}
