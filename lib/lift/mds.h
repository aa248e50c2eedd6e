/* Classical multidimensional scaling (section 3.3).
 *
 * SPDX-License-Identifier: MIT
 */

/* What counts as zero in the Gram matrix, see zeros: the first three relative to its largest entry.
 * Their effect on the points is measured in tests/test_mds.c. */
#define FINEST REAL(5.9604644775390625e-8) /* 2^-24: rounding */
#define TIGHT REAL(9.5367431640625e-7)     /* 2^-20 */
#define LOOSE REAL(0.0078125)              /* 2^-7 */
#define ANGLE REAL(0.00006103515625)        /* 2^-14 */

/* Double centring: the Gram matrix J A J of centred points, A = -D^2/2, has the null vector
 * (1, ..., 1).  Instead of subtracting means, reflect that vector onto the last axis: I - u u'/h
 * with u = (ALPHA, ..., ALPHA, 1 + ALPHA) and h = u'u/2 = 1 + ALPHA.  Row and column 13 are then
 * void, and an eigenproblem of order 13 remains. */
#define ALPHA REAL(0.26726124191242438) /* 1/sqrt(14) */
#define SHARE REAL(0.21089672205953698) /* ALPHA / (1 + ALPHA) */

/* gram: upper triangle of order 13.  D <= 3 m: entries before centring <= 4.5 m^2, row sums <= 58.5,
 * Frobenius norm <= 4.5 sqrt(182) = 60.7, which no projection or rotation makes larger. */
static void restricted_gram(real gram[][EDML_JOINTS], const real distance[EDML_PAIRS])
{
    enum { LAST = EDML_JOINTS - 1 };
    real row_sum[EDML_JOINTS] = {0};
    const real *d = distance;
    for (int i = 0; i < EDML_JOINTS; i++) {
        gram[i][i] = 0;
        for (int j = i + 1; j < EDML_JOINTS; j++, d++) {
            const real entry = -MUL(*d, *d) / 2;
            gram[i][j] = entry;
            row_sum[i] += entry;
            row_sum[j] += entry;
        }
    }
    /* A' = A - u q' - q u', q = p - (u'p / 2h) u, p = A u / h */
    real *const p = row_sum;
    real along = 0; /* u'p / h */
    for (int i = 0; i < EDML_JOINTS; i++) {
        p[i] = MUL(SHARE, row_sum[i]) + MUL(REAL(1.0) - SHARE, gram[i][LAST]);
        along += i < LAST ? MUL(SHARE, p[i]) : p[i];
    }
    for (int i = 0; i < LAST; i++)
        for (int j = i; j < LAST; j++) gram[i][j] -= MUL(ALPHA, p[i] + p[j] - MUL(ALPHA, along));
}

static real largest_entry(real a[][EDML_JOINTS], int order)
{
    real largest = 0;
    for (int i = 0; i < order; i++)
        for (int j = i; j < order; j++)
            if (ABS(a[i][j]) > largest) largest = ABS(a[i][j]);
    return largest;
}

/* Undoes the reflection: y [13] in the restricted basis, y[13] to be filled -> joints [14]. */
static void unrestrict(real y[EDML_JOINTS])
{
    real sum = 0;
    for (int i = 0; i < EDML_JOINTS - 1; i++) sum += y[i];
    const real shift = MUL(SHARE, sum);
    for (int i = 0; i < EDML_JOINTS - 1; i++) y[i] -= MUL(ALPHA, shift);
    y[EDML_JOINTS - 1] = -shift - MUL(ALPHA, shift);
}

static void set_coordinate(point *p, int axis, real value)
{
    if (axis == 0)
        p->x = value;
    else if (axis == 1)
        p->y = value;
    else
        p->z = value;
}

void NAME(edml_mds)(point x[EDML_JOINTS], const real distance[EDML_PAIRS], work_memory *work)
{
    enum { ORDER = EDML_JOINTS - 1, ROOM = (int)(sizeof work->use.turn / sizeof work->use.turn[0]) };
    real(*gram)[EDML_JOINTS] = work->matrix.at;
    restricted_gram(gram, distance);
    const real scale = largest_entry(gram, ORDER);
    const zeros zero = {MUL(LOOSE, scale) + EPSILON, MUL(TIGHT, scale) + EPSILON,
                        MUL(FINEST, scale) + EPSILON, ANGLE};
    const int count = diagonalise(work->use.turn, ROOM, gram, ORDER, zero);
    int axis[3];
    real length[3];
    for (int k = 0; k < 3; k++) {
        axis[k] = 0;
        for (int i = 1; i < ORDER; i++)
            if (gram[i][i] > gram[axis[k]][axis[k]]) axis[k] = i;
        const real value = gram[axis[k]][axis[k]];
        length[k] = value > 0 ? SQRT(value) : 0; /* negative: clamped */
        gram[axis[k]][axis[k]] = -scale;         /* taken */
    }
    real(*y)[EDML_JOINTS] = gram; /* a row a coordinate; the matrix has been read */
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < EDML_JOINTS; j++) y[k][j] = j == axis[k] ? length[k] : 0;
    turn_back(y, 3, work->use.turn, count);
    for (int k = 0; k < 3; k++) {
        unrestrict(y[k]);
        for (int j = 0; j < EDML_JOINTS; j++) set_coordinate(&x[j], k, y[k][j]);
    }
}
