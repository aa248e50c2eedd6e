/* The pose or its mirror image (section 3.3: "the degree of anthropomorphism"): they differ in the signs of
 * the depths.
 *
 * A rule that tells them apart is an odd function of how far bones point forward of the torso.  This one
 * is linear: thighs point forward, shins backward, and so on.  The model brings its five weights.  A network
 * that gives points needs no rule.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_MIRROR_H
#define EDML_MIRROR_H

#include "../geometry/torso.h"
#include "../network/model.h"

real edml_mirror(point x[EDML_JOINTS], const edml_model *model)
{
    const point chest = forward(x, EDML_R_SHOULDER, EDML_L_SHOULDER);
    const point pelvis = forward(x, EDML_R_HIP, EDML_L_HIP);
    real score = 0;
    for (int n = 0; n < OUTER_BONES; n++) {
        const int kind = outer_bones[n].kind;
        const point bone = direction(minus(x[outer_bones[n].to], x[outer_bones[n].from]));
        score += MUL(PARAM(model->mirror[kind]), dot(bone, kind < THIGHS ? chest : pelvis));
    }
    if (score < 0)
        for (int j = 0; j < EDML_JOINTS; j++) x[j].z = -x[j].z;
    return ABS(score);
}

#endif
