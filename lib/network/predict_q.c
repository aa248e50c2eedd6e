/* The network in the fixed-point lift.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

void edml__run_network_q(const edml_model *model, void *memory)
{
    edml_work_q *const work = (edml_work_q *)memory;
    model->predict_q(work->io.values, work->io.values, model, &work->scratch);
}
