/* SPDX-License-Identifier: MIT */
#include "helpers.h"

void setUp(void) {}
void tearDown(void) {}

/* ---- Random numbers ------------------------------------------------------------------------ */

rng rng_seed(uint32_t seed)
{
    rng r = {seed * 2654435761U + 1U};
    return r;
}

/* xorshift32 (Marsaglia); never zero. */
uint32_t rng_bits(rng *r)
{
    r->state ^= r->state << 13;
    r->state ^= r->state >> 17;
    r->state ^= r->state << 5;
    return r->state;
}

float uniform(rng *r, float low, float high)
{
    const float part = (float)(rng_bits(r) >> 8) / 16777216.0F;
    return low + (high - low) * part;
}

float gauss(rng *r)
{
    float sum = 0;
    for (int n = 0; n < 12; n++) sum += uniform(r, -0.5F, 0.5F);
    return sum;
}

/* ---- Rotations ----------------------------------------------------------------------------- */

/* From a random unit quaternion. */
rotation3 random_rotation(rng *r)
{
    double q[4], size = 0;
    for (int n = 0; n < 4; n++) {
        q[n] = (double)gauss(r);
        size += q[n] * q[n];
    }
    for (int n = 0; n < 4; n++) q[n] /= sqrt(size);
    const double w = q[0], x = q[1], y = q[2], z = q[3];
    const rotation3 turn = {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
    return turn;
}

void rotate_points(edml_point out[EDML_JOINTS], rotation3 by, const edml_point x[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        double turned[3];
        for (int n = 0; n < 3; n++)
            turned[n] = by.at[n][0] * (double)x[j].x + by.at[n][1] * (double)x[j].y +
                        by.at[n][2] * (double)x[j].z;
        out[j].x = (float)turned[0];
        out[j].y = (float)turned[1];
        out[j].z = (float)turned[2];
    }
}

void reflect(edml_point out[EDML_JOINTS], const edml_point x[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j] = x[j];
        out[j].z = -x[j].z;
    }
}

/* ---- People and points ----------------------------------------------------------------------- */

/* Mid-hip at the origin; elbows point back, wrists, knees and the chin forward: toward -z. */
void human_pose(edml_point x[EDML_JOINTS])
{
    static const edml_point standing[EDML_JOINTS] = {
        {0.01F, -0.80F, -0.05F}, {0.00F, -0.56F, 0.00F},                             /* head, neck */
        {-0.18F, -0.50F, 0.01F}, {-0.25F, -0.23F, -0.02F}, {-0.22F, -0.08F, -0.24F}, /* right arm */
        {0.18F, -0.50F, 0.00F},  {0.27F, -0.24F, -0.05F},  {0.24F, -0.12F, -0.29F},  /* left arm */
        {-0.13F, 0.00F, 0.00F},  {-0.15F, 0.42F, -0.12F},  {-0.16F, 0.84F, 0.02F},   /* right leg */
        {0.13F, 0.00F, 0.00F},   {0.15F, 0.43F, -0.05F},   {0.17F, 0.85F, 0.11F},    /* left leg */
    };
    memcpy(x, standing, sizeof standing);
}

void random_human(rng *r, edml_point x[EDML_JOINTS])
{
    edml_point stand[EDML_JOINTS];
    human_pose(stand);
    x[EDML_NECK_BASE] = stand[EDML_NECK_BASE];
    for (int n = 0; n < EDML_BONES; n++) {
        const edml_point from = stand[edml_bones[n].from], to = stand[edml_bones[n].to];
        const double length = distance_between(from, to);
        double bone[3] = {(double)(to.x - from.x), (double)(to.y - from.y), (double)(to.z - from.z)};
        double size = 0;
        for (int k = 0; k < 3; k++) {
            bone[k] += length * 0.5 * (double)gauss(r);
            size += bone[k] * bone[k];
        }
        const double stretch = length / sqrt(size);
        const edml_point start = x[edml_bones[n].from];
        x[edml_bones[n].to].x = start.x + (float)(stretch * bone[0]);
        x[edml_bones[n].to].y = start.y + (float)(stretch * bone[1]);
        x[edml_bones[n].to].z = start.z + (float)(stretch * bone[2]);
    }
}

void random_points(rng *r, edml_point x[EDML_JOINTS], float size)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j].x = uniform(r, -size, size);
        x[j].y = uniform(r, -size, size);
        x[j].z = uniform(r, -size, size);
    }
}

void root_at_mid_hip(edml_point x[EDML_JOINTS])
{
    const edml_point a = x[EDML_R_HIP], b = x[EDML_L_HIP];
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j].x -= (a.x + b.x) / 2;
        x[j].y -= (a.y + b.y) / 2;
        x[j].z -= (a.z + b.z) / 2;
    }
}

void equal_points(edml_point x[EDML_JOINTS], float x0, float y0, float z0)
{
    const edml_point all = {x0, y0, z0};
    for (int j = 0; j < EDML_JOINTS; j++) x[j] = all;
}

/* ---- Distances and photographs --------------------------------------------------------------- */

double distance_between(edml_point a, edml_point b)
{
    const double x = (double)a.x - (double)b.x, y = (double)a.y - (double)b.y;
    const double z = (double)a.z - (double)b.z;
    return sqrt(x * x + y * y + z * z);
}

void pair_distances(float d[EDML_PAIRS], const edml_point x[EDML_JOINTS])
{
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = i + 1; j < EDML_JOINTS; j++) d[EDML_PAIR(i, j)] = (float)distance_between(x[i], x[j]);
}

void noisy_distances(rng *r, float d[EDML_PAIRS], const edml_point x[EDML_JOINTS], float noise)
{
    pair_distances(d, x);
    for (int n = 0; n < EDML_PAIRS; n++) {
        d[n] += noise * gauss(r);
        if (d[n] < 0) d[n] = 0; /* as after the network's last ReLU */
    }
}

void photograph(edml_keypoint in[EDML_JOINTS], const edml_point x[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = 500.0F + 200.0F * x[j].x;
        in[j].y = 400.0F + 200.0F * x[j].y;
        in[j].c = 1.0F;
    }
}

void add_noise(rng *r, edml_keypoint in[EDML_JOINTS], float pixels)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x += pixels * gauss(r);
        in[j].y += pixels * gauss(r);
    }
}

double size_in_image(const edml_keypoint in[EDML_JOINTS])
{
    double x = 0, y = 0, size = 0, count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) count += in[j].c > 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(in[j].c > 0)) continue;
        x += (double)in[j].x / count;
        y += (double)in[j].y / count;
    }
    for (int j = 0; j < EDML_JOINTS; j++)
        if (in[j].c > 0) size += (fabs((double)in[j].x - x) + fabs((double)in[j].y - y)) / count;
    return size;
}

void draw_image(edml_image *image, const edml_point x[EDML_JOINTS], uint16_t seen)
{
    memset(image, 0, sizeof *image);
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(seen >> j & 1)) continue;
        image->at[j].u = x[j].x / 0.85F;
        image->at[j].v = x[j].y / 0.85F;
    }
    image->down.v = 1;
    image->seen = seen;
}

void turn_to_camera(edml_point x[EDML_JOINTS], edml_image_point down)
{
    const double u = (double)down.u, v = (double)down.v;
    const rotation3 turn = {{{v, u, 0}, {-u, v, 0}, {0, 0, 1}}};
    rotate_points(x, turn, x);
    root_at_mid_hip(x);
}

/* ---- Comparisons ----------------------------------------------------------------------------- */

float worse(float a, float b) { return a > b || isnan(a) ? a : b; }

float worst_distance_error(const edml_point x[EDML_JOINTS], const float d[EDML_PAIRS])
{
    float worst = 0;
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i + 1; j < EDML_JOINTS; j++) {
            const double error = distance_between(x[i], x[j]) - (double)d[EDML_PAIR(i, j)];
            worst = worse(worst, (float)fabs(error));
        }
    }
    return worst;
}

float worst_joint_error(const edml_point x[EDML_JOINTS], const edml_point y[EDML_JOINTS])
{
    float worst = 0;
    for (int j = 0; j < EDML_JOINTS; j++) worst = worse(worst, (float)distance_between(x[j], y[j]));
    return worst;
}

/* Sign of the determinant of the 3x3 matrix of second moments of one with the other, centred. */
int same_handedness(const edml_point x[EDML_JOINTS], const edml_point y[EDML_JOINTS])
{
    double mean_x[3] = {0}, mean_y[3] = {0}, m[3][3] = {{0}};
    for (int pass = 0; pass < 2; pass++) {
        for (int j = 0; j < EDML_JOINTS; j++) {
            const double a[3] = {(double)x[j].x, (double)x[j].y, (double)x[j].z};
            const double b[3] = {(double)y[j].x, (double)y[j].y, (double)y[j].z};
            for (int k = 0; k < 3; k++) {
                mean_x[k] += pass == 0 ? a[k] / EDML_JOINTS : 0;
                mean_y[k] += pass == 0 ? b[k] / EDML_JOINTS : 0;
                for (int l = 0; l < 3 && pass == 1; l++) m[k][l] += (a[k] - mean_x[k]) * (b[l] - mean_y[l]);
            }
        }
    }
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
               m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) >
           0;
}

int all_finite(const void *floats, int count)
{
    const float *value = floats;
    for (int n = 0; n < count; n++)
        if (!isfinite(value[n])) return 0;
    return 1;
}
