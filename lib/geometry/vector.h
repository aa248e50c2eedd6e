/* Vectors of three, and points of the image.
 *
 * SPDX-License-Identifier: MIT
 */

typedef struct {
    real u, v;
} image_point;

static point plus(point a, point b)
{
    const point sum = {a.x + b.x, a.y + b.y, a.z + b.z};
    return sum;
}

static point minus(point a, point b)
{
    const point difference = {a.x - b.x, a.y - b.y, a.z - b.z};
    return difference;
}

static point times(real scale, point a)
{
    const point product = {MUL(scale, a.x), MUL(scale, a.y), MUL(scale, a.z)};
    return product;
}

static void add_multiple(point *sum, real scale, point a)
{
    sum->x += MUL(scale, a.x);
    sum->y += MUL(scale, a.y);
    sum->z += MUL(scale, a.z);
}

static real dot(point a, point b) { return MUL(a.x, b.x) + MUL(a.y, b.y) + MUL(a.z, b.z); }

static real norm(point a) { return NORM(a.x, a.y, a.z); }

static point over(point a, real divisor) /* |a| / 128 < divisor */
{
    const point quotient = {DIV(a.x, divisor), DIV(a.y, divisor), DIV(a.z, divisor)};
    return quotient;
}

static point cross(point a, point b)
{
    const point product = {MUL(a.y, b.z) - MUL(a.z, b.y), MUL(a.z, b.x) - MUL(a.x, b.z),
                           MUL(a.x, b.y) - MUL(a.y, b.x)};
    return product;
}
