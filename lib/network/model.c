/* What can be asked of a model.
 *
 * SPDX-License-Identifier: MIT
 */
#include "model.h"

const char *edml_model_name(const edml_model *model) { return model->name; }

edml_status edml_model_check(const edml_model *model)
{
    if (model == NULL) return EDML_ERR_ARGUMENT;
    return model->hash(model) == model->checksum ? EDML_OK : EDML_ERR_MODEL;
}
