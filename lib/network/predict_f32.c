/* The network in the float lift: float ones as they are, quantised ones between conversions.
 *
 * SPDX-License-Identifier: MIT
 */
#include "../number/real_f32.h"
#include "model.h"

#include Q24

void edml__run_network(const edml_model *model, void *memory)
{
    edml_network_work *const network = &((edml_work *)memory)->of.network;
    float *const values = network->io.values;
    int32_t *const integers = network->io.integers; /* in the same place */
    if (model->predict_f32 != NULL) {
        model->predict_f32(values, values, model, &network->units);
        return;
    }
    to_q24(integers, values, model->inputs);
    model->predict_q(integers, integers, model, &network->units);
    from_q24(values, integers, edml__output_values(model));
}
