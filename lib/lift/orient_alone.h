/* What follows the MDS where a network gives distances and nothing else: refinement, the rotation to the body's
 * frame by the image, and the mirror image by the limbs (section 3.3).  Models of such networks name it, so that
 * programs with others do not link it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ORIENT_ALONE_H
#define EDML_ORIENT_ALONE_H

#include "../network/model.h"
#include "mirror.h"
#include "orient.h"
#include "refine.h"

EDML_INTERNAL edml_status edml__orient_alone(edml_work *work, const edml_model *model)
{
    (void)edml_refine(work->x, work->prediction.distance, (edml_objective)model->objective,
                      model->refine_steps, work);
    const edml_status status = edml_orient(work->x, &work->image);
    if (status == EDML_OK) (void)edml_mirror(work->x, model);
    return status;
}

#endif
