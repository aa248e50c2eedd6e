/* The network in the float lift: float ones as they are, quantised ones between conversions.
 *
 * SPDX-License-Identifier: MIT
 */
#include "../number/real_f32.h"
#include "model.h"

#define ONE_Q24 16777216.0F

void edml__run_network(const edml_model *model, void *memory)
{
    edml_network_work *const network = &((edml_work *)memory)->of.network;
    float *const values = network->io.values;
    int32_t *const integers = network->io.integers; /* in the same place */
    if (model->predict_f32 != NULL) {
        model->predict_f32(values, values, model, &network->units);
        return;
    }
    const int inputs = model->inputs, outputs = edml__output_values(model);
    for (int k = 0; k < inputs; k++) integers[k] = (int32_t)(values[k] * ONE_Q24); /* below 12 */
    model->predict_q(integers, integers, model, &network->units);
    for (int k = 0; k < outputs; k++) values[k] = (float)integers[k] / ONE_Q24;
}
