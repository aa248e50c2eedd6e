/* The network in the fixed-point lift.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

typedef char work_memory_holds_the_network[sizeof(((edml_network_work_q *)0)->io) == 4 * EDML_MAX_VALUES &&
                                                   sizeof(((edml_network_work_q *)0)->units) >= 4 * EDML_MAX_VALUES
                                               ? 1
                                               : -1];

void edml__run_network_q(const edml_model *model, void *memory)
{
    edml_network_work_q *const network = &((edml_work_q *)memory)->of.network;
    model->predict_q(network->io.values, network->io.values, model, &network->units);
}
