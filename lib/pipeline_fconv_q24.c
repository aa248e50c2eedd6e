/* The fixed-point pipeline with FConv for its network, which takes more memory.
 *
 * SPDX-License-Identifier: MIT
 */
#include "real_q24.h"

#include "seen.inc"

void edml_net_fconv_q24(int32_t distance[EDML_PAIRS], const int32_t edm[EDML_PAIRS],
                        const edml_model *model, edml_fconv_work_q24 *work)
{
    const edml_fconv *net = model->layers;
    net->predict_q24(distance, edm, net->layers, &work->maps);
}

#define LIFT_BY_FCONV
#include "lift.inc"
