/* How good is a pose?  A logistic model of what the pose and its image show, with a sigmoid that
 * needs no exponential.
 *
 * tools/fit_person.py fits these numbers; they belong to the shipped networks.
 *
 * SPDX-License-Identifier: MIT
 */

/* Lengths in metres beyond which bones are not people's. */
static const struct {
    real least, most;
} bone_limits[EDML_BONES] = {
    {REAL(0.25), REAL(0.33)},                                                     /* head */
    {REAL(0.18), REAL(0.22)}, {REAL(0.21), REAL(0.32)}, {REAL(0.20), REAL(0.32)}, /* right arm */
    {REAL(0.18), REAL(0.22)}, {REAL(0.21), REAL(0.32)}, {REAL(0.20), REAL(0.32)},
    {REAL(0.39), REAL(0.50)}, {REAL(0.37), REAL(0.44)}, {REAL(0.37), REAL(0.47)}, /* trunk, leg */
    {REAL(0.39), REAL(0.50)}, {REAL(0.37), REAL(0.44)}, {REAL(0.37), REAL(0.47)},
};

/* Weights, and where what they weigh is cut off. */
#define MARGIN REAL(0.427)
#define MOST_MARGIN REAL(2.0)
#define RESIDUAL REAL(17.418) /* a metre */
#define MISFIT REAL(23.256)   /* a metre */
#define MOST_METRES REAL(0.5) /* of either */
#define MISSING REAL(0.551)   /* a joint */
#define MOST_MISSING 4        /* joints; the networks want the others */
#define BEYOND REAL(6.757)    /* a metre */
#define MOST_BEYOND REAL(4.0) /* metres, of all bones */
#define CONSTANT REAL(2.351)

static real cut_off(reported a, real most) { return a < RESULT(most) ? GIVEN(a) : most; }

/* Metres by which bones are shorter or longer than people's, in all. */
static real beyond_limits(const pose *lifted)
{
    real sum = 0;
    for (int n = 0; n < EDML_BONES; n++) {
        const real length = norm(minus(given_joint(lifted, edml_bones[n].to),
                                       given_joint(lifted, edml_bones[n].from)));
        if (length < bone_limits[n].least) sum += bone_limits[n].least - length;
        if (length > bone_limits[n].most) sum += length - bone_limits[n].most;
        if (sum > MOST_BEYOND) return MOST_BEYOND; /* before the next one, of up to 14 m */
    }
    return sum;
}

/* Farthest coordinate of the image from the first one. */
static pixels reach_from(keypoint first, const keypoint in[EDML_JOINTS], uint16_t seen)
{
    pixels reach = 0; /* <= 2^30 */
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(seen >> j & 1)) continue;
        if (ABS(in[j].x - first.x) > reach) reach = ABS(in[j].x - first.x);
        if (ABS(in[j].y - first.y) > reach) reach = ABS(in[j].y - first.y);
    }
    return reach;
}

/* RMS difference in metres of the seen joints from the image, at its best scale and place; `most` if
 * it is more, or the image a point. */
static real misfit(const pose *lifted, const keypoint in[EDML_JOINTS], uint16_t seen, real most)
{
    int first = 0;
    while (!(seen >> first & 1)) first++;
    const pixels reach = reach_from(in[first], in, seen);
    if (!(reach > 0)) return most;
    const real part = REAL(1.0) / (real)count_bits(seen);
    point p_mean = {0, 0, 0}, q_mean = {0, 0, 0};
    real pp = 0, pq = 0, qq = 0; /* means: <= 32, 8 and 2 */
    for (int j = first; j < EDML_JOINTS; j++) {
        if (!(seen >> j & 1)) continue;
        const point at = given_joint(lifted, j), p = {at.x, at.y, 0};
        const point q = {DIV(in[j].x - in[first].x, reach), DIV(in[j].y - in[first].y, reach), 0};
        add_multiple(&p_mean, part, p);
        add_multiple(&q_mean, part, q);
        pp += MUL(part, dot(p, p));
        pq += MUL(part, dot(p, q));
        qq += MUL(part, dot(q, q));
    }
    pp -= dot(p_mean, p_mean);
    pq -= dot(p_mean, q_mean);
    qq -= dot(q_mean, q_mean); /* >= 1 / 28: a joint is 1 away from the first */
    const real square = pq > 0 ? pp - MUL(DIV(pq, qq), pq) : pp; /* pq / qq <= sqrt(pp / qq) */
    if (!(square < MUL(most, most))) return most; /* NaN, too */
    return square > 0 ? SQRT(square) : 0;
}

reported NAME(edml_quality)(const pose *lifted, const keypoint in[EDML_JOINTS])
{
    if (lifted == NULL || in == NULL || !is_pose(lifted)) return 0;
    const uint16_t seen = seen_joints(in);
    const int missing = EDML_JOINTS - count_bits(seen);
    if (!all_finite(in, seen) || missing > MOST_MISSING) return 0;
    if (!(lifted->mirror_margin >= 0 && lifted->residual >= 0)) return 0;
    const real margin = cut_off(lifted->mirror_margin, MOST_MARGIN);
    const real residual = cut_off(lifted->residual, MOST_METRES);
    const real off = misfit(lifted, in, seen, MOST_METRES);
    const real score = CONSTANT + MUL(MARGIN, margin) - MUL(RESIDUAL, residual) -
                       MUL(MISFIT, off) - (real)missing * MISSING - MUL(BEYOND, beyond_limits(lifted));
    return RESULT((REAL(1.0) + DIV(score, HYPOT(REAL(1.0), score))) / 2); /* |score| <= 55 */
}
