/* Pose or mirror image (section 3.3: "the degree of anthropomorphism").
 *
 * A mirror test can only be an odd function of how far things point forward of the torso.  Here it
 * is a linear one: knees bend forward, elbows too, and so on; its five weights come with the model.
 *
 * SPDX-License-Identifier: MIT
 */

real NAME(edml_mirror)(point x[EDML_JOINTS], const edml_model *model)
{
    const point chest = forward(x, EDML_R_SHOULDER, EDML_L_SHOULDER);
    const point pelvis = forward(x, EDML_R_HIP, EDML_L_HIP);
    real score = 0;
    for (int n = 0; n < 9; n++) {
        const int of = outer_bones[n].kind;
        const point bone = direction(minus(x[outer_bones[n].to], x[outer_bones[n].from]));
        score += MUL(SETTING(model->mirror[of]), dot(bone, of < THIGHS ? chest : pelvis));
    }
    if (score < 0)
        for (int j = 0; j < EDML_JOINTS; j++) x[j].z = -x[j].z;
    return ABS(score);
}
