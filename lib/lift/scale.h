/* From the distances that a network gives to points in the body's frame.  A model names the function that it needs, so
 * that a program whose network gives points alone links none.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_SCALE_H
#define EDML_SCALE_H

#include "../network/model.h"
#include "align.h"
#include "mds.h"
#include "mirror.h"
#include "orient.h"
#include "refine.h"

/* Where the network gives points as well. */
EDML_INTERNAL edml_status edml__scale_and_align(edml_work *work, const edml_model *model)
{
    edml_mds(work->x, work->of.points.prediction.distance, work);
    edml_align(work->x, work->of.points.prediction.x, model);
    return EDML_OK;
}

/* Where it gives nothing else: refinement, the rotation to the body's frame by the image, and the mirror image by the
 * limbs (section 3.3). */
EDML_INTERNAL edml_status edml__scale_and_orient(edml_work *work, const edml_model *model)
{
    edml_mds(work->x, work->of.points.prediction.distance, work);
    (void)edml_refine(work->x, work->of.points.prediction.distance, (edml_objective)model->objective,
                      model->refine_steps, work);
    const edml_status status = edml_orient(work->x, &work->image);
    if (status == EDML_OK) (void)edml_mirror(work->x, model);
    return status;
}

#endif
