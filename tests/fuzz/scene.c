/* People, and how cameras and detectors see them.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scene.h"

#include <float.h>
#include <math.h>
#include <string.h>

/* ---- Vectors -------------------------------------------------------------------------------------- */

static place3 sum_of(place3 a, place3 b)
{
    const place3 sum = {a.x + b.x, a.y + b.y, a.z + b.z};
    return sum;
}

static place3 scaled(double scale, place3 a)
{
    const place3 product = {scale * a.x, scale * a.y, scale * a.z};
    return product;
}

static place3 rotated(const double q[4], place3 v) /* by a unit quaternion */
{
    const place3 u = {q[1], q[2], q[3]};
    const double w = q[0], d = u.x * v.x + u.y * v.y + u.z * v.z;
    const double uu = u.x * u.x + u.y * u.y + u.z * u.z;
    const place3 cross = {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
    return sum_of(sum_of(scaled(2 * d, u), scaled(w * w - uu, v)), scaled(2 * w, cross));
}

/* A rotation by up to `most` of half a turn. */
static void draw_rotation(double q[4], double most, choices *from)
{
    double square = 0;
    q[0] = 1;
    for (int n = 1; n < 4; n++) q[n] = most * draw_between(from, -1, 1);
    if (most >= 1) q[0] = draw_between(from, -1, 1);
    for (int n = 0; n < 4; n++) square += q[n] * q[n];
    for (int n = 0; n < 4; n++) q[n] = square > 0 ? q[n] / sqrt(square) : n == 0;
}

/* ---- Points --------------------------------------------------------------------------------------- */

/* Someone who stands and faces the camera, centimetres. */
static const signed char standing[EDML_JOINTS][3] = {
    {0, -68, 2}, {0, -44, 0}, {-18, -46, 0}, {-22, -18, 3}, {-20, 6, -6}, {18, -46, 0}, {22, -18, 3},
    {20, 6, -6}, {-11, 0, 0}, {-12, 41, -1}, {-12, 83, 2},  {11, 0, 0},   {12, 41, -1}, {12, 83, 2},
};

static void draw_human(place3 x[EDML_JOINTS], choices *from)
{
    double q[4];
    const double strength = draw_between(from, 0, 0.7), size = draw_between(from, 0.6, 1.2);
    place3 bone[EDML_JOINTS];
    for (int n = 0; n < EDML_BONES; n++) {
        const signed char *a = standing[edml_bones[n].from], *b = standing[edml_bones[n].to];
        const place3 rest = {(b[0] - a[0]) / 100.0, (b[1] - a[1]) / 100.0, (b[2] - a[2]) / 100.0};
        draw_rotation(q, strength, from);
        bone[edml_bones[n].to] = scaled(size, rotated(q, rest));
    }
    memset(&x[EDML_NECK_BASE], 0, sizeof *x);
    for (int n = 0; n < EDML_BONES; n++)
        x[edml_bones[n].to] = sum_of(x[edml_bones[n].from], bone[edml_bones[n].to]);
    draw_rotation(q, draw_one_in(from, 2) ? 1 : 0.3, from);
    for (int j = 0; j < EDML_JOINTS; j++) x[j] = rotated(q, x[j]);
}

/* Nearly in a plane, on a line, or at a point; or in other proportions. */
static void press(place3 x[EDML_JOINTS], choices *from)
{
    static const double thin[] = {0, 1e-6, 1e-3, 0.02, 0.2, 4};
    const double u = thin[draw_below(from, 6)], v = draw_one_in(from, 2) ? thin[draw_below(from, 6)] : 1;
    double q[4];
    draw_rotation(q, draw_one_in(from, 2) ? 1 : 0, from);
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j].z *= u;
        x[j].y *= v;
        x[j] = rotated(q, x[j]);
    }
}

static double draw_coordinate(choices *from, double size, int corners)
{
    if (corners) return draw_one_in(from, 2) ? size : -size;
    return draw_between(from, -size, size);
}

/* Anywhere within a box, or at its corners, or at a few places of these. */
static void draw_cloud(place3 x[EDML_JOINTS], choices *from)
{
    const double size = draw_magnitude(from, 0.005, 3.99);
    const int corners = draw_one_in(from, 4),
              places = draw_one_in(from, 4) ? 1 + (int)draw_below(from, 8) : 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j].x = draw_coordinate(from, size, corners);
        x[j].y = draw_coordinate(from, size, corners);
        x[j].z = draw_coordinate(from, size, corners);
        if (places > 0 && j >= places) x[j] = x[j % places];
    }
}

void draw_points(place3 x[EDML_JOINTS], choices *from)
{
    const uint32_t kind = draw_below(from, 16);
    if (kind < 11)
        draw_human(x, from);
    else
        draw_cloud(x, from);
    if (kind >= 8 && kind < 13) press(x, from);
    if (kind >= 14)
        for (uint32_t n = draw_below(from, 4); n > 0; n--)
            x[draw_below(from, EDML_JOINTS)] = x[draw_below(from, EDML_JOINTS)];
    const place3 root = scaled(-0.5, sum_of(x[EDML_R_HIP], x[EDML_L_HIP]));
    for (int j = 0; j < EDML_JOINTS && kind != 15; j++) x[j] = sum_of(x[j], root);
}

void draw_pose(place3 x[EDML_JOINTS], choices *from)
{
    double most = 0;
    draw_points(x, from);
    for (int j = 0; j < EDML_JOINTS; j++)
        most = fmax(most, fmax(fabs(x[j].x), fmax(fabs(x[j].y), fabs(x[j].z))));
    if (draw_one_in(from, 16)) most /= draw_magnitude(from, 0.05, 4); /* of another size */
    const double scale = most > 3.9999 || most != most ? 3.9999 / most : 1;
    for (int j = 0; j < EDML_JOINTS; j++) x[j] = scaled(scale, x[j]);
    if (draw_one_in(from, 64)) x[draw_below(from, EDML_JOINTS)].y = draw_extreme(from);
}

/* ---- Images --------------------------------------------------------------------------------------- */

double draw_extreme(choices *from)
{
    static const double some[] = {0,     -0.0,       NAN,     INFINITY, -INFINITY, 8192,
                                  -8192, 8191.99999, -8191.5, FLT_MAX,  -FLT_MAX,  FLT_MIN,
                                  1e-42, 0x1p24,     -1,      1,        4,         -4,
                                  1e20,  -1e20,      1e-20,   0.25,     1e35,      65536};
    return some[draw_below(from, sizeof some / sizeof *some)];
}

void draw_camera(pinhole *by, place3 *far, choices *from)
{
    by->fx = draw_magnitude(from, 200, 4000);
    by->fy = draw_one_in(from, 4) ? by->fx * draw_between(from, 0.5, 2) : by->fx;
    by->cx = draw_between(from, 0, 2000);
    by->cy = draw_between(from, 0, 1200);
    far->z = draw_one_in(from, 4) ? draw_magnitude(from, 0.2, 150) : draw_between(from, 1.5, 8);
    far->x = far->z * draw_between(from, -0.8, 0.8);
    far->y = far->z * draw_between(from, -0.4, 0.4);
    if (!draw_one_in(from, 32)) return;
    double *const number[] = {&by->fx, &by->fy, &by->cx, &by->cy};
    *number[draw_below(from, 4)] = draw_extreme(from);
}

static void see(sighting *in, place3 at, const pinhole *by, place3 far)
{
    const place3 x = by == NULL ? at : sum_of(at, far);
    const double z = fmax(x.z, 0.05);
    in->x = by == NULL ? 200 * x.x + 1000 : by->fx * x.x / z + by->cx;
    in->y = by == NULL ? 200 * x.y + 500 : by->fy * x.y / z + by->cy;
    in->c = 1;
}

static void add_noise(sighting in[EDML_JOINTS], choices *from)
{
    const double noise = draw_magnitude(from, 0.1, 300);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x += noise * draw_between(from, -1, 1);
        in[j].y += noise * draw_between(from, -1, 1);
    }
}

/* Confidences from 0 to 1, some of them below 0 or tiny. */
static void doubt(sighting in[EDML_JOINTS], choices *from)
{
    const int missing = draw_one_in(from, 2);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].c = draw_bits(from, 1) / 255.0;
        if (draw_one_in(from, 64)) in[j].c = draw_one_in(from, 2) ? -1 : 1e-5;
        if (!missing && in[j].c == 0) in[j].c = 0.5;
    }
}

static void spoil(sighting in[EDML_JOINTS], choices *from)
{
    for (uint32_t n = 1 + draw_below(from, 3); n > 0; n--) {
        sighting *one = &in[draw_below(from, EDML_JOINTS)];
        double *const number[] = {&one->x, &one->y, &one->c};
        *number[draw_below(from, 3)] = draw_extreme(from);
    }
}

static void confuse(sighting in[EDML_JOINTS], choices *from)
{
    const uint32_t kind = draw_below(from, 3);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int other = kind == 0 ? edml_mirror_joint[j] : (int)draw_below(from, EDML_JOINTS);
        if (kind > 0 && !draw_one_in(from, 4)) continue;
        const sighting one = in[j];
        in[j] = in[other];
        if (kind < 2 && j < other) in[other] = one;
    }
}

/* Larger and smaller, here and there. */
static void zoom(sighting in[EDML_JOINTS], choices *from)
{
    const int wide = draw_one_in(from, 4);
    const double scale = draw_magnitude(from, wide ? 1e-30 : 0.01, wide ? 1e30 : 8);
    const double x = scale * draw_between(from, -4000, 4000), y = scale * draw_between(from, -4000, 4000);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = scale * in[j].x + x;
        in[j].y = scale * in[j].y + y;
    }
}

void draw_sightings(sighting in[EDML_JOINTS], const place3 x[EDML_JOINTS], const pinhole *by, place3 far,
                    choices *from)
{
    const uint32_t what = draw_bits(from, 2);
    for (int j = 0; j < EDML_JOINTS; j++) see(&in[j], x[j], by, far);
    if (what % 2) add_noise(in, from);
    if (what / 2 % 2) doubt(in, from);
    if (what / 4 % 8 == 0) confuse(in, from);
    if (what / 32 % 16 == 0) zoom(in, from);
    if (what / 512 % 32 == 0) spoil(in, from);
}

void draw_frame(sighting in[EDML_JOINTS], choices *from)
{
    place3 x[EDML_JOINTS], far;
    pinhole by;
    draw_points(x, from);
    const int near = draw_one_in(from, 2);
    draw_camera(&by, &far, from);
    draw_sightings(in, x, near ? &by : NULL, far, from);
}

void round_sightings(sighting in[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = fabs(in[j].x) < 2048 ? nearbyint(16 * in[j].x) / 16 : 2048;
        in[j].y = fabs(in[j].y) < 2048 ? nearbyint(16 * in[j].y) / 16 : -2048;
    }
}

int draw_up(place3 *up, choices *from)
{
    const uint32_t kind = draw_below(from, 16);
    const double size = draw_magnitude(from, 1e-3, 1e3);
    up->x = size * draw_between(from, -1, 1);
    up->y = size * draw_between(from, -1, 1);
    up->z = size * draw_between(from, -1, 1);
    if (kind == 15) up->x = draw_extreme(from);
    if (kind == 14) up->x = up->z = 0;
    if (kind == 13) memset(up, 0, sizeof *up);
    return kind >= 8;
}
