/* edml_mds(), edml_refine() and edml_stress() of any distances within their range.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS mds
#include "../native.h"

#define FARTHEST (IS_EXACT ? 4.0 : 3.0) /* metres */

static edml_work work;

/* Those of points, with errors; or any. */
static int draw_distances(double d[EDML_PAIRS], choices *from)
{
    place3 x[EDML_JOINTS];
    const uint32_t kind = draw_below(from, 4);
    const double error = kind == 0 ? 0 : draw_magnitude(from, 1e-4, 1);
    double *next = d;
    draw_points(x, from);
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i + 1; j < EDML_JOINTS; j++) {
            const double noise = kind < 2 ? 0 : error * draw_between(from, -1, 1);
            *next = kind == 3 ? draw_between(from, 0, FARTHEST) : distance_of(x[i], x[j]) + noise;
            if (kind == 1 && draw_one_in(from, 16)) *next = draw_one_in(from, 2) ? 0 : FARTHEST;
            *next = fmin(fmax(*next, 0), FARTHEST);
            next++;
        }
    }
    for (int k = 0; k < EDML_PAIRS; k++)
        if (d[k] >= FARTHEST) return 0;
    return kind == 0;
}

static place3 place_of(point p)
{
    const place3 place = {from_real(p.x), from_real(p.y), from_real(p.z)};
    return place;
}

/* Points whose distances these are have them again; any are about their mean, and no farther apart than the largest
 * eigenvalue lets them be (lib/lift/refine.h). */
static void check_points(const point x[EDML_JOINTS], const double d[EDML_PAIRS], int are_of_points)
{
    place3 sum = {0, 0, 0};
    for (int i = 0; i < EDML_JOINTS; i++) {
        const place3 p = place_of(x[i]);
        REQUIRE(fabs(p.x) + fabs(p.y) + fabs(p.z) < 4 * FARTHEST, "a point is too far away");
        sum.x += p.x;
        sum.y += p.y;
        sum.z += p.z;
        for (int j = i + 1; j < EDML_JOINTS && are_of_points; j++)
            REQUIRE(fabs(distance_of(p, place_of(x[j])) - d[EDML_PAIR(i, j)]) <= 0.006, "another distance");
    }
    REQUIRE(fabs(sum.x) + fabs(sum.y) + fabs(sum.z) <= 1e-3, "the mean is not the origin");
}

static double stress_of(const point x[EDML_JOINTS], const double d[EDML_PAIRS], edml_objective objective)
{
    double sum = 0;
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i + 1; j < EDML_JOINTS; j++) {
            const double found = distance_of(place_of(x[i]), place_of(x[j])), wanted = d[EDML_PAIR(i, j)];
            const double squares = found * found - wanted * wanted, off = found - wanted;
            sum += objective == EDML_STRESS_SQUARE ? squares * squares
                   : objective == EDML_STRESS_RAW  ? off * off
                                                   : fabs(squares);
        }
    }
    return objective == EDML_STRESS_NONE ? 0 : sum / EDML_PAIRS;
}

static void check_stress(const point x[EDML_JOINTS], const real distance[EDML_PAIRS],
                         const double d[EDML_PAIRS], edml_objective objective)
{
    const double found = from_real(edml_stress(x, distance, objective));
    const double sum = stress_of(x, d, objective),
                 most = IS_EXACT || objective == EDML_STRESS_NONE ? INFINITY : 64;
    double farthest = 0, squares = 0;
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = 0; j < i; j++) {
            const double apart = distance_of(place_of(x[i]), place_of(x[j]));
            farthest = fmax(farthest, apart);
            squares += apart * apart;
        }
    }
    if (most == 64 && (fabs(farthest - 8) < 0.01 || fabs(squares - 448) < 0.01)) return;
    const double wanted = most == 64 && (farthest > 8 || squares > 448) ? 64 : fmin(sum, most);
    const double root = IS_EXACT ? 0 : 1e-3; /* lengths of squares of Q24 are off by 2^-12 */
    REQUIRE(fabs(found - wanted) <= 1e-4 * wanted + root * sqrt(wanted) + 1e-5, "another stress");
}

/* The objective never rises, but for rounding. */
static void check_refinement(point x[EDML_JOINTS], const real distance[EDML_PAIRS],
                             const double d[EDML_PAIRS], choices *from)
{
    const edml_objective objective = (edml_objective)draw_below(from, 4);
    const int most = (int)draw_below(from, 12);
    check_stress(x, distance, d, objective);
    const double before = stress_of(x, d, objective);
    const int steps = edml_refine(x, distance, objective, most, &work);
    const double after = stress_of(x, d, objective);
    REQUIRE(steps >= 0 && steps <= most, "another number of steps");
    REQUIRE(after <= before * (1 + 1e-3) + 1e-6, "the objective has risen");
    check_stress(x, distance, d, objective);
}

void FUZZ_TARGET(mds)(choices *from)
{
    double d[EDML_PAIRS];
    real distance[EDML_PAIRS];
    point x[EDML_JOINTS];
    place3 other[EDML_JOINTS];
    const int are_of_points = draw_distances(d, from);
    for (int k = 0; k < EDML_PAIRS; k++) {
        distance[k] = to_real(d[k]);
        d[k] = from_real(distance[k]);
    }
    edml_mds(x, distance, &work);
    check_points(x, d, are_of_points);
#ifdef EDML_FUZZ_Q
    int32_t watched[EDML_JOINTS][3];
    const edml_objective objective = (edml_objective)draw_below(from, 4);
    point refined[EDML_JOINTS];
    checked_tally taken;
    memcpy(refined, x, sizeof refined);
    if (fuzz_watches) {
        const int steps = edml_refine(refined, distance, objective, 6, &work);
        REQUIRE(checked_refine(watched, distance, objective, 6, &taken) == steps,
                "another number of watched steps");
        REQUIRE(taken.overflows == 0, "a number overflows");
        REQUIRE(memcmp(refined, watched, sizeof refined) == 0, "not what watched numbers give");
    }
#endif
    check_refinement(x, distance, d, from);
    draw_points(other, from); /* which have nothing to do with the distances */
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j].x = to_real(other[j].x);
        x[j].y = to_real(other[j].y);
        x[j].z = to_real(other[j].z);
    }
    check_refinement(x, distance, d, from);
}
