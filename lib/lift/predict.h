/* The network's part of the lift (section 3.2): from the image to what the model gives.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_PREDICT_H
#define EDML_PREDICT_H

#include <string.h>

#include "inputs.h"

/* Pairs with a joint that was not seen are zero, where joints are not imputed. */
static void clear_missing(real edm[EDML_PAIRS], uint16_t seen)
{
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = i + 1; j < EDML_JOINTS; j++, edm++)
            if (!(is_seen(seen, i) && is_seen(seen, j))) *edm = 0;
}

/* As edml_predict(), with a model that can be run.  Inline, because the stack is deepest in the network. */
static EDML_INLINE void predict(edml_prediction *out, const edml_image *image, const point *up,
                                const edml_model *model, edml_work *work)
{
    real *const values = work->of.network.io.values;
    if (model->reads & EDML_READS_BODY) {
        network_inputs(values, image, up, model, out->distance);
        RUN_NETWORK(model, work);
        take_outputs(out, values, model);
        return;
    }
    edml_edm(values, image);
    if (model->imputation == NULL) clear_missing(values, image->seen);
    RUN_NETWORK(model, work);
    memcpy(out->distance, values, sizeof out->distance);
    for (int j = 0; j < EDML_JOINTS; j++) out->share[j] = PARAM(model->fusion[FUSION_SHARE]);
}

edml_status edml_predict(edml_prediction *out, const edml_image *image, const point *up,
                         const edml_model *model, void *work, size_t work_bytes)
{
    if (out == NULL || image == NULL || model == NULL || work == NULL) return EDML_ERR_ARGUMENT;
    const edml_status status = edml__check_model(model, WORK_BYTES(model), work, work_bytes);
    if (status == EDML_OK) predict(out, image, up, model, (edml_work *)work);
    return status;
}

#endif
