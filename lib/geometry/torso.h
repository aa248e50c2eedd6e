/* The torso's front, and the nine bones that move against the torso.
 *
 * SPDX-License-Identifier: MIT
 */

enum { ARMS, FOREARMS, HEAD, THIGHS, SHINS };

/* Right and left take turns; forearms and shins come two after the bone that they hang on. */
static const struct {
    uint8_t from, to, kind;
} outer_bones[9] = {
    {EDML_NECK, EDML_HEAD_TOP, HEAD},
    {EDML_R_SHOULDER, EDML_R_ELBOW, ARMS},
    {EDML_L_SHOULDER, EDML_L_ELBOW, ARMS},
    {EDML_R_ELBOW, EDML_R_WRIST, FOREARMS},
    {EDML_L_ELBOW, EDML_L_WRIST, FOREARMS},
    {EDML_R_HIP, EDML_R_KNEE, THIGHS},
    {EDML_L_HIP, EDML_L_KNEE, THIGHS},
    {EDML_R_KNEE, EDML_R_ANKLE, SHINS},
    {EDML_L_KNEE, EDML_L_ANKLE, SHINS},
};

static point middle(point a, point b)
{
    const point half = {(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2};
    return half;
}

/* Unit vector; or none, where there is no length.  Of the points of any distances up to 3 m, all
 * vectors here are under 11 m; of poses within 4 m on each axis, under 14 m. */
static point direction(point a)
{
    const point none = {0, 0, 0};
    const real length = norm(a);
    return length > EPSILON ? over(a, length) : none;
}

/* Normal of the torso, from its back to its front: (toward the subject's left) x (upward). */
static point forward(const point x[EDML_JOINTS], int right, int left)
{
    const point up = minus(x[EDML_NECK], middle(x[EDML_R_HIP], x[EDML_L_HIP]));
    return direction(cross(direction(minus(x[left], x[right])), direction(up)));
}
