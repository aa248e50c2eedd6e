/* The network in the float lift: float ones as they are, quantised ones between conversions.
 *
 * SPDX-License-Identifier: MIT
 */
#include "../number/real_f32.h"
#include "model.h"

#define ONE_Q24 16777216.0F

void edml__run_network(const edml_model *model, void *memory)
{
    edml_work *const work = (edml_work *)memory;
    float *const values = work->io.values;
    int32_t *const integers = work->io.integers; /* in the same place */
    if (model->predict_f32 != NULL) {
        model->predict_f32(values, values, model, &work->scratch);
        return;
    }
    for (int k = 0; k < model->inputs; k++) integers[k] = (int32_t)(values[k] * ONE_Q24); /* below 12 */
    model->predict_q(integers, integers, model, &work->scratch);
    for (int k = 0; k < edml__output_values(model); k++) values[k] = (float)integers[k] / ONE_Q24;
}
