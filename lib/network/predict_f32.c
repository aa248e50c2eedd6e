/* The network in the float lift: float ones as they are, quantised ones between conversions.
 *
 * SPDX-License-Identifier: MIT
 */
#include "../number/real_f32.h"
#include "model.h"

#if BY_HELIUM
#include "q24_mve.h"
#elif BY_VFP
#include "q24_vfp.h"
#else
#include "q24_by_value.h"
#endif

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
