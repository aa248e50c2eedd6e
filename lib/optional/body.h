/* What is known of the person: a pose of the size that its owner has.
 *
 * A pose made larger is the pose of a matrix made larger, for the stages between them keep ratios.
 * Bones of known length keep their direction, and the others their length; that brings joints nearer
 * to the truth than a refinement that weighs the known distances heavily (docs/person.md).
 *
 * tools/fit_person.py measures the shares.
 *
 * SPDX-License-Identifier: MIT
 */

/* As shares of the standing height: each bone, the height itself; and the way from head top to ankle
 * along the bones. */
static const real share_of[EDML_BONES + 1] = {
    REAL(0.165),                           /* head */
    REAL(0.113), REAL(0.168), REAL(0.159), /* right clavicle, upper arm, forearm */
    REAL(0.113), REAL(0.168), REAL(0.159), /* left */
    REAL(0.261), REAL(0.230), REAL(0.246), /* right trunk, thigh, shin */
    REAL(0.261), REAL(0.230), REAL(0.246), /* left */
    REAL(1.0),
};
#define CHAIN REAL(0.902)

#define SHORTEST REAL(0.5) /* metres, standing height */
#define TALLEST REAL(2.5)
#define AGREE REAL(1.6) /* ratio of the heights that the bones of one person stand for; seen: 1.44 */

/* Limits of what all of a pose is multiplied by.  Its bones are 14 m long at most. */
enum { ENLARGED = 2, REDUCED = 8 };

enum { HEAD_BONE = 0, FIRST_LEG_BONE = 7 };

/* The standing height for which a measure stands; 0 if no person has that. */
static real height_of(reported given, real share)
{
    if (!(given > 0 && given < RESULT(LARGEST))) return 0; /* NaN is not */
    const real height = DIV(GIVEN(given), share); /* < 36 */
    return height >= SHORTEST && height <= TALLEST ? height : 0;
}

/* Are the numbers those of a person, of one and the same? */
static int is_person(const person *owner)
{
    real least = TALLEST, most = SHORTEST;
    for (int n = 0; n <= EDML_BONES; n++) {
        const reported given = n < EDML_BONES ? owner->bone[n] : owner->height;
        if (given == 0) continue;
        const real height = height_of(given, share_of[n]);
        if (height == 0) return 0;
        if (height < least) least = height;
        if (height > most) most = height;
    }
    return most <= MUL(AGREE, least);
}

/* What bones of unknown length are multiplied by; 0 if the pose is far from the person's size. */
static real scale_of(reported height, const real length[EDML_BONES])
{
    if (height == 0) return REAL(1.0);
    const real wanted = MUL(CHAIN, GIVEN(height));
    real has = length[HEAD_BONE]; /* <= 4 * 14 */
    for (int n = FIRST_LEG_BONE; n < EDML_BONES; n++) has += length[n] / 2;
    return wanted / ENLARGED <= has && has / REDUCED <= wanted ? DIV(wanted, has) : 0;
}

/* Joints about the neck: the person's bones in the directions of the pose's; 0 if these have none, or the
 * pose's size is far off.  No joint is more than 3 * 2 * 8 m from the neck, along an axis. */
static int resize(point y[EDML_JOINTS], const point x[EDML_JOINTS], const person *owner)
{
    real length[EDML_BONES];
    for (int n = 0; n < EDML_BONES; n++)
        length[n] = norm(minus(x[edml_bones[n].to], x[edml_bones[n].from]));
    const real scale = scale_of(owner->height, length);
    if (scale == 0) return 0;
    y[EDML_NECK] = minus(x[EDML_NECK], x[EDML_NECK]);
    for (int n = 0; n < EDML_BONES; n++) { /* from the neck outwards */
        const int to = edml_bones[n].to, from = edml_bones[n].from;
        const real known = GIVEN(owner->bone[n]);
        if (known / 64 > length[n]) return 0;
        y[to] = y[from];
        add_multiple(&y[to], known != 0 ? DIV(known, length[n]) : scale, minus(x[to], x[from]));
    }
    return 1;
}

edml_status NAME(edml_fit_person)(pose *fitted, const person *owner)
{
    if (fitted == NULL || owner == NULL) return EDML_ERR_ARGUMENT;
    if (!is_pose(fitted)) return EDML_ERR_NOT_FINITE;
    if (!is_person(owner)) return EDML_ERR_PERSON;
    point x[EDML_JOINTS], y[EDML_JOINTS];
    for (int j = 0; j < EDML_JOINTS; j++) x[j] = given_joint(fitted, j);
    if (!resize(y, x, owner)) return EDML_ERR_DEGENERATE;
    const point root = times(REAL(0.5), plus(y[EDML_R_HIP], y[EDML_L_HIP]));
    for (int j = 0; j < EDML_JOINTS; j++) fitted->joint[j] = result(minus(y[j], root));
    return EDML_OK;
}
