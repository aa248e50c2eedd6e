/* The network in the fixed-point pipeline.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

void edml_net_q24(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                  const edml_model *model, edml_work_q24 *work)
{
    model->predict_q24(distance, edm, model, work->use.layer);
}
