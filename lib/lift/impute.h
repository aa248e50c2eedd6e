/* Guesses where in the image joints are that were not seen.
 *
 * The 2D joints of people are taken for one Gaussian, the same for x and y.  Given all the others, a
 * joint is then expected at a weighted mean of them (tools/fit_completion.py); given those that were
 * seen, guessed joints follow each other as well, which is a linear system.
 *
 * SPDX-License-Identifier: MIT
 */

/* As many as a square matrix of them fits an EDM. */
enum { MOST_GUESSED = 9 };

#define LEAST_PIVOT REAL(0.01)

/* The system of `count` joints, (1 - W) x = sum over the seen of W x: the matrix, and right sides to
 * where the joints will be.  |weight| < 8, rows of it: sums below 3.4, of absolute values. */
static void set_up(real *a, image_point at[EDML_JOINTS], const uint8_t *guessed, int count,
                   uint16_t seen, const edml_completion *completion)
{
    for (int p = 0; p < count; p++) {
        const int16_t *weight = completion->weight[guessed[p]];
        image_point sum = {0, 0};
        for (int j = 0; j < EDML_JOINTS; j++) {
            if (!(seen >> j & 1)) continue;
            sum.u += MUL(FRACTION(weight[j]), at[j].u);
            sum.v += MUL(FRACTION(weight[j]), at[j].v);
        }
        at[guessed[p]] = sum;
        for (int q = 0; q < count; q++) a[p * count + q] = -FRACTION(weight[guessed[q]]);
        a[p * count + p] = REAL(1.0);
    }
}

static void subtract(image_point *from, real part, image_point at)
{
    from->u -= MUL(part, at.u);
    from->v -= MUL(part, at.v);
}

/* at: of joints that were not seen, |u|, |v| come out below 11 times the largest that was.
 * a: [MOST_GUESSED * MOST_GUESSED], work memory.
 * Elimination without a search for pivots: but for the scale of its rows the matrix is a part of the
 * inverse of a covariance, so that pivots are positive; of the usual completion 0.04 and up.  Returns 0
 * if they are not. */
static EDML_APART int complete(image_point at[EDML_JOINTS], uint16_t seen,
                                const edml_completion *completion, real *a)
{
    uint8_t guessed[MOST_GUESSED];
    int count = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        if (!(seen >> j & 1)) guessed[count++] = (uint8_t)j;
    set_up(a, at, guessed, count, seen, completion);
    for (int p = 0; p < count; p++) {
        const real *pivot = a + p * count;
        if (!(pivot[p] > LEAST_PIVOT)) return 0;
        for (int row = p + 1; row < count; row++) {
            real *below = a + row * count;
            const real part = DIV(below[p], pivot[p]);
            for (int q = p + 1; q < count; q++) below[q] -= MUL(part, pivot[q]);
            subtract(&at[guessed[row]], part, at[guessed[p]]);
        }
    }
    for (int p = count - 1; p >= 0; p--) {
        image_point *x = &at[guessed[p]];
        for (int q = p + 1; q < count; q++) subtract(x, a[p * count + q], at[guessed[q]]);
        x->u = DIV(x->u, a[p * count + p]);
        x->v = DIV(x->v, a[p * count + p]);
    }
    return 1;
}
