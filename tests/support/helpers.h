/* What the Unity tests use: random numbers, points, rotations, a person.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TEST_HELPERS_H
#define EDML_TEST_HELPERS_H

#include <math.h>
#include <stdint.h>
#include <string.h>

#include <unity.h>

#include "edmlift.h"
#include "edmlift/angles.h"
#include "edmlift/body.h"
#include "edmlift/camera.h"
#include "edmlift/stages.h"
#include "edmlift/video.h"
#include "q24.h"
#include "tolerance.h"

enum { ALL_SEEN = (1 << EDML_JOINTS) - 1 };

/* Random numbers: the same on every machine, as no libm is asked. */
typedef struct {
    uint32_t state;
} rng;
rng rng_seed(uint32_t seed);
uint32_t rng_bits(rng *r);
float uniform(rng *r, float low, float high);
float gauss(rng *r); /* nearly: a sum of twelve uniforms */

typedef struct {
    double at[3][3];
} rotation3;
rotation3 random_rotation(rng *r);
void rotate_points(edml_point out[EDML_JOINTS], rotation3 by, const edml_point x[EDML_JOINTS]);
void reflect(edml_point out[EDML_JOINTS], const edml_point x[EDML_JOINTS]); /* z -> -z */

/* People and points, in metres. */
void human_pose(edml_point x[EDML_JOINTS]); /* stands, faces the camera, limbs bent as limbs bend */
void random_human(rng *r, edml_point x[EDML_JOINTS]); /* its bones, each turned by up to a radian */
void random_points(rng *r, edml_point x[EDML_JOINTS], float size);
void root_at_mid_hip(edml_point x[EDML_JOINTS]); /* which becomes the origin */
void equal_points(edml_point x[EDML_JOINTS], float x0, float y0, float z0);

/* Distances, in double, rounded once. */
double distance_between(edml_point a, edml_point b);
void pair_distances(float d[EDML_PAIRS], const edml_point x[EDML_JOINTS]);
void noisy_distances(rng *r, float d[EDML_PAIRS], const edml_point x[EDML_JOINTS], float noise);

/* A scaled-orthographic photograph, 200 pixels a metre, all joints seen. */
void photograph(edml_keypoint in[EDML_JOINTS], const edml_point x[EDML_JOINTS]);

/* Errors of so many pixels (a standard deviation) in a photograph. */
void add_noise(rng *r, edml_keypoint in[EDML_JOINTS], float pixels);

/* Mean |x| + |y| of the seen joints from their middle, in pixels. */
double size_in_image(const edml_keypoint in[EDML_JOINTS]);

/* The same as an image that is not turned, 0.85 m being 1; (0, 0, any depth) is at its origin. */
void draw_image(edml_image *image, const edml_point x[EDML_JOINTS], uint16_t seen);

/* From the body's frame, of which `down` is an axis, to the camera's axes; mid-hip becomes the origin. */
void turn_to_camera(edml_point x[EDML_JOINTS], edml_image_point down);

/* The larger one; NaN is the largest of all. */
float worse(float a, float b);

/* Comparisons, in metres. */
float worst_distance_error(const edml_point x[EDML_JOINTS], const float d[EDML_PAIRS]);
float worst_joint_error(const edml_point x[EDML_JOINTS], const edml_point y[EDML_JOINTS]);
int same_handedness(const edml_point x[EDML_JOINTS], const edml_point y[EDML_JOINTS]);
int all_finite(const void *floats, int count);

#define TEST_ASSERT_SAME_BYTES(expected, actual)                                                           \
    TEST_ASSERT_EQUAL_MEMORY(&(expected), &(actual), sizeof(expected))

/* error <= bound, and not NaN */
#define TEST_ASSERT_ERROR_UP_TO(bound, error) TEST_ASSERT_FLOAT_WITHIN((bound), 0.0F, (error))

#endif
