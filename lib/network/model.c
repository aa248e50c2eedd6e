/* What can be asked of a model.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

const char *edml_model_name(const edml_model *model) { return model->name; }

edml_status edml_model_check(const edml_model *model)
{
    if (model == NULL) return EDML_ERR_ARGUMENT;
    return model->compute_checksum(model) == model->checksum ? EDML_OK : EDML_ERR_MODEL;
}

size_t edml_model_work_bytes(const edml_model *model) { return model->work_bytes; }

size_t edml_model_work_bytes_q(const edml_model *model) { return model->work_bytes_q; }
