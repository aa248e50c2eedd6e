/* Gradient refinement of the points (section 3.3): conjugate gradient with exact line search.
 *
 * Each objective is the sum w (d^2 - D^2)^2, whose weights w give it, at the current points, the objective's
 * own gradient; along a line that sum is a quartic.  For s-stress w = 1.  For eq. 2, w = 1 / |d^2 - D^2|, the
 * usual reweighting.  For raw stress w = 1 / (2 d (d + D)), whose curvature is right at d = D as well.
 * Divisors have a minimum.  Factors that all w have in common are left out.
 *
 * Ranges.  D is in [0, 3] m.  Points are at most 8 m apart, and their squares about the mean, 1/14 of those of
 * all pairs, add up to at most 32 m^2, else no step is taken to them or from them.  So along no axis they are
 * wider than those of the MDS: the Gram matrix of such distances has no eigenvalue above 31.5 m^2, because
 * u'Gu = -u'(D^2)u / 2 <= 9 s^2 for a unit u that adds up to 0, whose positive entries
 * add up to s <= sqrt(14) / 2.  Hence d^2 <= 64 and -9 <= d^2 - D^2 <= 64.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_REFINE_H
#define EDML_REFINE_H

#include "../geometry/vector.h"

#define MIN_DIVISOR REAL(0.00390625) /* m^2; smaller divisors are clamped to this */

#define MAX_STEP REAL(4.0) /* m; the line search goes no further, along an axis */

/* ---- Powers of two ---- */

/* The factor up / down, one of which is 1; both are plain numbers. */
typedef struct {
    wide up, down;
} power_of_two;

/* The power of two that scales a number > 0 to between 1/2 and 1, or towards it: at most 2^40. */
static power_of_two towards_one(wide something)
{
    power_of_two p = {1, 1};
    for (int n = 0; n < 40 && something < REAL(0.5); n++, something *= 2) p.up *= 2;
    for (int n = 0; n < 40 && something >= REAL(1.0); n++, something /= 2) p.down *= 2;
    return p;
}

static real scale_by(wide a, power_of_two by)
{
    return TRUNCATE_TO(REAL(64.0), a * by.up / by.down); /* what is scaled below 1 is |a| / 64 at least */
}

static real largest_component(const point a[EDML_JOINTS])
{
    real largest = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (ABS(a[j].x) > largest) largest = ABS(a[j].x);
        if (ABS(a[j].y) > largest) largest = ABS(a[j].y);
        if (ABS(a[j].z) > largest) largest = ABS(a[j].z);
    }
    return largest;
}

/* ---- Objective ---- */

static real squared_length(point a)
{
    const real square = SATURATE(PRODUCT(a.x, a.x) + PRODUCT(a.y, a.y) + PRODUCT(a.z, a.z));
    ASSUME(square >= 0); /* a sum of squares */
    return square;
}

/* excess: d^2 - D^2; square: d^2. */
static wide stress_term(edml_objective objective, real excess, real square, real distance)
{
    if (objective == EDML_STRESS_SQUARE) return PRODUCT(excess, excess);
    if (objective == EDML_STRESS_EQ2) return PRODUCT(ABS(excess), REAL(1.0));
    const real d = SQRT(square) - distance;
    return PRODUCT(d, d);
}

/* Sum of the objective over the pairs, <= 91 * 64^2; WIDE_MAX if two points are 8 m apart or more, or the
 * squares of all pairs add up to 7 * 64 m^2 or more. */
static wide total_stress(const point x[EDML_JOINTS], const real distance[EDML_PAIRS],
                         edml_objective objective)
{
    wide sum = 0;
    real spread = 0;
    const real *d = distance;
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i + 1; j < EDML_JOINTS; j++, d++) {
            const real square = squared_length(minus(x[i], x[j]));
            spread += square / 7;
            if (!IS_NEAR(square) || !IS_NEAR(spread)) return WIDE_MAX;
            sum += stress_term(objective, square - SQUARE(*d), square, *d);
        }
    }
    return sum;
}

real edml_stress(const point x[EDML_JOINTS], const real distance[EDML_PAIRS], edml_objective objective)
{
    if (objective == EDML_STRESS_NONE) return 0;
    return SATURATE(total_stress(x, distance, objective) / (int)EDML_PAIRS);
}

/* ---- Gradient ---- */

/* 1 / w, or 1 / (2 w) for raw stress: 1/256 to 88. */
static real divisor(edml_objective objective, real excess, real square, real distance)
{
    if (objective == EDML_STRESS_SQUARE) return REAL(1.0);
    const real wanted = objective == EDML_STRESS_EQ2 ? ABS(excess) : square + MUL(SQRT(square), distance);
    return wanted > MIN_DIVISOR ? wanted : MIN_DIVISOR;
}

/* A plain number that gradients are divided by.  The objective's total, which only falls from here on,
 * chooses it: small, to lose no digits, yet with |out| <= 52 and |weighted excess| <= 72 below.  Of s-stress
 * |out| <= 8 sqrt(13 total) / unit.  Of the others |out| <= 13 * 8 / unit, and where |d - D| <= s,
 * |d^2 - D^2| / divisor <= 256 (s^2 + s/8): of raw stress s <= sqrt(total); s <= 3 where d < D. */
static real gradient_unit(edml_objective objective, wide total)
{
    if (objective == EDML_STRESS_EQ2) return 2;
    if (objective == EDML_STRESS_RAW) return total <= PRODUCT(REAL(1.0), REAL(1.0)) ? 4 : 32;
    real unit = 1;
    for (wide most = PRODUCT(REAL(3.25), REAL(1.0)); unit < 128 && total > most; most *= 4) unit *= 2;
    return unit;
}

/* w (d^2 - D^2), up to a factor. */
static real weighted_excess(edml_objective objective, real unit, real excess, real square, real distance)
{
    if (objective == EDML_STRESS_SQUARE) return excess / unit;
    /* gradient_unit() says why */
    return DIV_TO(REAL(72.0), excess / unit, divisor(objective, excess, square, distance));
}

/* The downhill direction: minus the gradient, up to a factor.  |out| <= 52 on each axis. */
static void downhill(point out[EDML_JOINTS], const point x[EDML_JOINTS], const real distance[EDML_PAIRS],
                     edml_objective objective, real unit)
{
    const point zero = {0, 0, 0};
    for (int i = 0; i < EDML_JOINTS; i++) out[i] = zero;
    const real *d = distance;
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i + 1; j < EDML_JOINTS; j++, d++) {
            const point delta = minus(x[i], x[j]);
            ASSUME(ALL_WITHIN(delta, REAL(8.0))); /* else no step is taken from them */
            const real square = squared_length(delta);
            const real excess = square - SQUARE(*d);
            const real weighted = weighted_excess(objective, unit, excess, square, *d);
            /* the first is so of s-stress and eq. 2; of raw stress the product is within 8 / unit */
            ASSUME(WITHIN(weighted, REAL(9.0)) || ALL_WITHIN(delta, REAL(1.0)));
            const point part = times(weighted, delta);
            out[i] = minus(out[i], part);
            out[j] = plus(out[j], part);
            /* gradient_unit() says why */
            ASSUME(ALL_WITHIN(out[i], REAL(52.0)) && ALL_WITHIN(out[j], REAL(52.0)));
        }
    }
}

/* ---- Line search ---- */

/* Along a line the sum of w (r + b t + a t^2)^2 is c0 + c1 t + ... + c4 t^4. */
typedef struct {
    wide c1, c2, c3, c4;
} quartic;

/* step: < 1 on each axis, so that |b| <= 2 * 8 * 2 sqrt(3) < 56, a <= 12; w <= 1; |r| <= 64. */
static quartic along(const point x[EDML_JOINTS], const point step[EDML_JOINTS],
                     const real distance[EDML_PAIRS], edml_objective objective)
{
    quartic sum = {0, 0, 0, 0}; /* c1 < 2^20, c2 < 2^19, c3 < 2^17, c4 < 2^14 */
    const real *d = distance;
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i + 1; j < EDML_JOINTS; j++, d++) {
            const point delta = minus(x[i], x[j]);
            ASSUME(ALL_WITHIN(delta, REAL(8.0))); /* else no step is taken from them */
            const point move = minus(step[i], step[j]);
            const real square = squared_length(delta);
            const real r = square - SQUARE(*d);
            const real b = 2 * dot(delta, move);
            const real a = squared_length(move);
            real wb = b, wa = a;
            if (objective != EDML_STRESS_SQUARE) {
                const real w = DIV(MIN_DIVISOR, divisor(objective, r, square, *d));
                wb = MUL(w, b);
                wa = MUL(w, a);
            }
            sum.c1 += 2 * PRODUCT(wb, r);
            sum.c2 += PRODUCT(wb, b) + 2 * PRODUCT(wa, r);
            sum.c3 += 2 * PRODUCT(wa, b);
            sum.c4 += PRODUCT(wa, a);
        }
    }
    return sum;
}

/* Slope of the quartic, a cubic with positive leading coefficient, in a unit that makes the largest
 * coefficient 1/2 to 1. */
typedef struct {
    real at0, at1, at2, at3; /* at0 + at1 t + at2 t^2 + at3 t^3 */
} cubic;

static cubic slope_of(quartic sum)
{
    const wide all[] = {sum.c1, 2 * sum.c2, 3 * sum.c3, 4 * sum.c4};
    wide largest = 0;
    for (int n = 0; n < 4; n++)
        if (ABS(all[n]) > largest) largest = ABS(all[n]);
    const power_of_two p = towards_one(largest);
    const cubic slope = {scale_by(all[0], p), scale_by(all[1], p), scale_by(all[2], p),
                         scale_by(all[3], p)};
    /* none is above the largest */
    ASSUME(WITHIN(slope.at0, REAL(1.0)) && WITHIN(slope.at1, REAL(1.0)));
    ASSUME(WITHIN(slope.at2, REAL(1.0)) && WITHIN(slope.at3, REAL(1.0)));
    return slope;
}

static real slope_at(const cubic *s, real t) /* t <= 4: 5, 21 and 85 at most, from the inside out */
{
    return s->at0 + MUL(t, s->at1 + MUL(t, s->at2 + MUL(t, s->at3)));
}

/* A t at which the slope is not negative any more, no other change of sign before it: its first
 * local maximum where the cubic rises above zero there, else by doubling. */
static real bracket(const cubic *s)
{
    const real discriminant = SQUARE(s->at2) - 3 * MUL(s->at1, s->at3);
    if (s->at2 < 0 && s->at1 > 0 && discriminant > 0) {
        const real fall = SQRT(discriminant) - s->at2; /* <= 3 */
        /* else 4 is less */
        const real peak = s->at1 < MUL(MAX_STEP, fall) ? DIV_TO(MAX_STEP, s->at1, fall) : MAX_STEP;
        if (slope_at(s, peak) >= 0) return peak;
    }
    real high = REAL(1.0);
    while (high < MAX_STEP && slope_at(s, high) < 0) high *= 2;
    return high;
}

/* First minimum of the quartic for t > 0, or MAX_STEP; 0 where it does not fall. */
static real line_minimum(quartic sum)
{
    const cubic slope = slope_of(sum);
    if (slope.at0 >= 0) return 0;
    real low = 0, high = bracket(&slope);
    for (int n = 0; n < 24; n++) {
        const real halfway = (low + high) / 2;
        if (slope_at(&slope, halfway) < 0)
            low = halfway;
        else
            high = halfway;
    }
    return low;
}

/* ---- Conjugate gradient ---- */

static wide inner_product(const point a[EDML_JOINTS], const point b[EDML_JOINTS])
{
    wide sum = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        sum += PRODUCT(a[j].x, b[j].x) + PRODUCT(a[j].y, b[j].y) + PRODUCT(a[j].z, b[j].z);
    return sum;
}

/* Polak-Ribiere+: how much of the last direction is kept.  Restarts (0) at 64 or more: the gradient grew so
 * much that the old direction is useless. */
static real kept_fraction(const point now[EDML_JOINTS], const point before[EDML_JOINTS])
{
    const wide square = inner_product(before, before);
    const wide gain = inner_product(now, now) - inner_product(now, before);
    if (!(gain > 0 && gain / 64 < square)) return 0;
    const power_of_two p = towards_one(square);
    return DIV_TO(REAL(64.1), scale_by(gain, p), scale_by(square, p)); /* gain / square < 64 */
}

/* now + kept step; each kept component is clamped to +-64, and |now| <= 52. */
static void next_direction(point step[EDML_JOINTS], const point now[EDML_JOINTS], real kept)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        step[j].x = now[j].x + SATURATE(PRODUCT(kept, step[j].x));
        step[j].y = now[j].y + SATURATE(PRODUCT(kept, step[j].y));
        step[j].z = now[j].z + SATURATE(PRODUCT(kept, step[j].z));
    }
}

/* tried: the best points along the step, from x. */
static void try_step(point tried[EDML_JOINTS], const point x[EDML_JOINTS], const point step[EDML_JOINTS],
                     const real distance[EDML_PAIRS], edml_objective objective)
{
    const power_of_two p = towards_one(largest_component(step));
    for (int j = 0; j < EDML_JOINTS; j++) {
        tried[j].x = scale_by(step[j].x, p);
        tried[j].y = scale_by(step[j].y, p);
        tried[j].z = scale_by(step[j].z, p);
        ASSUME(ALL_WITHIN(tried[j], REAL(1.0))); /* none is above the largest */
    }
    const real t = line_minimum(along(x, tried, distance, objective));
    for (int j = 0; j < EDML_JOINTS; j++) tried[j] = plus(x[j], times(t, tried[j]));
}

int edml_refine(point x[EDML_JOINTS], const real distance[EDML_PAIRS], edml_objective objective, int steps,
                edml_work *work)
{
    point(*const steps_of)[EDML_JOINTS] = work->of.points.stage.step;
    point *now = steps_of[0], *before = steps_of[1], *step = steps_of[2], *tried = steps_of[3];
    if (objective == EDML_STRESS_NONE) return 0;
    const point zero = {0, 0, 0};
    for (int j = 0; j < EDML_JOINTS; j++) before[j] = step[j] = zero;
    wide cost = total_stress(x, distance, objective);
    const real unit = gradient_unit(objective, cost);
    int taken = 0;
    for (; taken < steps && cost < WIDE_MAX; taken++) {
        downhill(now, x, distance, objective, unit);
        next_direction(step, now, kept_fraction(now, before));
        try_step(tried, x, step, distance, objective);
        const wide reached = total_stress(tried, distance, objective);
        if (!(reached < cost)) break;
        for (int j = 0; j < EDML_JOINTS; j++) {
            x[j] = tried[j];
            before[j] = now[j];
        }
        cost = reached;
    }
    return taken;
}

#endif
