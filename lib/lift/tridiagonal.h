/* The largest eigenvalue of a tridiagonal matrix, and the QL sweep that splits it off.
 *
 * The matrix is a band [n][2], as householder.h makes it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TRIDIAGONAL_H
#define EDML_TRIDIAGONAL_H

#include "../api/api.h"

enum { MOST_STEPS = 24 };           /* 2 or 3 are usual */
#define LAST_STEP REAL(9.765625e-4) /* 2^-10; the error after it is about its cube */

/* Divides the matrix by its Frobenius norm, which it returns; 0 if there is nothing.  In fixed point entries
 * are within 1 before, and the norm is 1/2 to 5. */
static EDML_NOINLINE real divide_by_norm(real *band, int n)
{
    const int bits = NORMALISE(band, 2 * n);
    wide square = 0;
    for (int i = 0; i < 2 * n; i += 2)
        square += EXACT(band[i], band[i]) + 2 * EXACT(band[i + 1], band[i + 1]);
    ASSUME(square >= 0); /* a sum of squares */
    const real norm = ROOT_OF_EXACT(square);
    if (!(norm > 0)) return 0;
    ASSUME(norm >= REAL(0.49)); /* its largest entry is 1/2 or more */
    const real scale = DIV(REAL(1.0), norm);
    for (int i = 0; i < 2 * n; i++) {
        band[i] = MUL(scale, band[i]);
        ASSUME(WITHIN(band[i], REAL(1.001))); /* as the norm is 1 */
    }
    return SHIFT_TO(REAL(62.0), norm, -bits); /* of the whole matrix at most */
}

/* A leading minor and the one before, or a derivative of both, times 2^exponent.  In fixed point the larger
 * one is in [1/2, 1) then: near a root f is far smaller than f', and f' than f'', and needs all its bits. */
typedef struct {
    real at[2];
    int exponent;
} minors;

/* Three-term recurrence: x - d is within 2, e^2 within 1/2, and what the derivative adds within 64. */
static void next_minor(minors *m, real gap, real square, real more)
{
    const real next = FROM_EXACT(EXACT(gap, m->at[0]) - EXACT(square, m->at[1])) + more;
    m->at[1] = m->at[0];
    m->at[0] = next;
    m->exponent += NORMALISE(m->at, 2);
}

/* m in units of 2^exponent.  It is below 64 of them, unless rounding is all that is left of either. */
static real in_units(const minors *m, int exponent)
{
    const int by = exponent - m->exponent;
    return SHIFT(m->at[0], by < 6 ? by : 6);
}

/* f, f' and f''/2 at x of the characteristic polynomial f.  None is negative above its roots.  Nothing is in the same
 * place, so that they may stay in registers. */
static EDML_NOINLINE void characteristic(minors *EDML_RESTRICT f, minors *EDML_RESTRICT slope,
                                         minors *EDML_RESTRICT curve, const real *EDML_RESTRICT band, int n,
                                         real x)
{
    const minors of_order_1[3] = {{{x - band[0], REAL(1.0)}, 0}, {{REAL(1.0), 0}, 0}, {{0, 0}, 0}};
    *f = of_order_1[0];
    *slope = of_order_1[1];
    *curve = of_order_1[2];
    for (int i = 1; i < n; i++) {
        const real gap = x - band[2 * i], square = SQUARE(band[2 * i - 1]);
        next_minor(curve, gap, square, in_units(slope, curve->exponent));
        next_minor(slope, gap, square, in_units(f, slope->exponent));
        next_minor(f, gap, square, 0);
    }
    f->exponent += NORMALISE(f->at, 1);
    slope->exponent += NORMALISE(slope->at, 1);
    curve->exponent += NORMALISE(curve->at, 1);
}

/* Laguerre's step from x to the largest root: of order n, `share` = 2 n / (n - 1).  As all roots are real, it is
 * not too long, but where many of them are so near that rounding decides.  0: x is at the root, to rounding. */
static real laguerre_step(const minors *f, const minors *slope, const minors *curve, int n, real share)
{
    const int exponent = slope->exponent - f->exponent, bent = exponent + slope->exponent - curve->exponent;
    if (!(f->at[0] > 0 && slope->at[0] > 0) || exponent > 2) return 0; /* Newton's step is within 2 */
    ASSUME(slope->at[0] >= REAL(0.5)); /* normalised */
    const real newton = DIV(f->at[0], slope->at[0]), bend = DIV(curve->at[0], slope->at[0]); /* within 2 */
    ASSERT(newton <= REAL(2.001) && WITHIN(bend, REAL(2.001)));
    const real part = bent > 1 ? REAL(1.0)
                               : MUL(share, SHIFT(MUL(newton, bend), bent)); /* to 1, or rounding */
    const real root = part < REAL(1.0) ? SQRT(REAL(1.0) - part) : 0;
    return SHIFT(DIV((real)n * newton, REAL(1.0) + (real)(n - 1) * root), exponent);
}

/* Largest eigenvalue of a matrix of norm 1, from above; where many nearly coincide, it may be wrong. */
static EDML_NOINLINE real largest_eigenvalue(const real *band, int n)
{
    const real share = DIV((real)(2 * n), (real)(n - 1));
    real x = REAL(1.0);
    for (int step = 0; step < MOST_STEPS; step++) {
        minors f, slope, curve;
        characteristic(&f, &slope, &curve, band, n, x);
        const real length = laguerre_step(&f, &slope, &curve, n, share);
        x -= length;
        ASSUME(WITHIN(x, REAL(2.0))); /* near the largest eigenvalue, or where rounding took it */
        if (length <= LAST_STEP) break;
    }
    return x;
}

/* Are all eigenvalues below x?  Then all leading minors of x - A are positive. */
static EDML_NOINLINE int is_above_all(const real *band, int n, real x)
{
    minors f = {{x - band[0], REAL(1.0)}, 0};
    for (int i = 1; i < n && f.at[0] > 0; i++)
        next_minor(&f, x - band[2 * i], SQUARE(band[2 * i - 1]), 0);
    return f.at[0] > 0;
}

/* The rotation of (x, z) onto the first axis; by nothing if both are zero. */
static edml_plane_rotation onto_first(real x, real z)
{
    edml_plane_rotation rotation = {REAL(1.0), 0};
    if (z == 0) return rotation;
    const int steep = ABS(z) > ABS(x);
    /* the larger one divides */
    const real tangent = steep ? DIV_TO(REAL(1.0), x, z) : DIV_TO(REAL(1.0), z, x);
    const real one = DIV(REAL(1.0), HYPOT(REAL(1.0), tangent)), other = MUL(tangent, one);
    rotation.cosine = steep ? other : one;
    rotation.sine = steep ? one : other;
    return rotation;
}

/* A QL sweep that subtracts an eigenvalue explicitly: what is beside band[0] becomes zero, and band[0] the
 * eigenvalue.  Records the rotations of axes i and i + 1, from the last i = n - 2 to the first.  (A sweep
 * that subtracts it implicitly is not forward stable.)  All numbers are within 2 norms.
 * band[-1], within 32, is what a sweep before this one left between its axis and the first one here, which turns. */
static EDML_NOINLINE void sweep(edml_plane_rotation *done, real *band, int n, real eigenvalue)
{
    real x = band[2 * n - 2] - eigenvalue, on_diagonal = x;
    edml_plane_rotation before = {REAL(1.0), 0};
    for (int i = n - 2; i >= 0; i--) {
        const real d = band[2 * i], e = band[2 * i + 1];
        const edml_plane_rotation turn = onto_first(x, e);
        /* all are within 2 norms */
        ASSUME(WITHIN(d, REAL(2.0)) && WITHIN(e, REAL(2.0)) && WITHIN(x, REAL(4.0)));
        if (i + 2 < n) band[2 * i + 3] = MUL(before.sine, FROM_EXACT(EXACT(turn.cosine, x) + EXACT(turn.sine, e)));
        x = FROM_EXACT(EXACT(turn.cosine, d - eigenvalue) - EXACT(turn.sine, MUL(before.cosine, e)));
        band[2 * i + 2] = d + on_diagonal;
        on_diagonal = MUL(turn.cosine, x);
        band[2 * i + 2] -= on_diagonal;
        *done++ = before = turn;
    }
    band[1] = MUL(before.sine, x);
    band[0] = eigenvalue + on_diagonal;
    band[-1] = MUL_TO(REAL(32.0), before.cosine, band[-1]); /* a cosine */
}

#endif
