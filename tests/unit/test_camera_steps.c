/* optional/camera/ from within: what each step of the iteration does.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "optional/camera_f32.c"

#include "helpers.h"

static const edml_camera camera = {1145, 1145, 500, 500};
static edml_work memory;
static edml_pose someone;
static matrix3 truth;        /* the rotation that places them, in the scene */
static point place_of_truth; /* of their origin, from the camera */

/* Someone 3 to 6 m away, noise in pixels on the image: a view of them. */
static scene random_view(rng *r, float noise)
{
    edml_keypoint image[EDML_JOINTS];
    edml_point x[EDML_JOINTS];
    scene v;
    v.joint = memory.scratch.step[0];
    v.ray = memory.scratch.step[1];
    v.a = memory.scratch.step[2];
    v.b = memory.scratch.step[3];
    const float depth = uniform(r, 3, 6), across = uniform(r, -1, 1);
    const rotation3 turn = random_rotation(r);
    random_human(r, someone.joint);
    rotate_points(x, turn, someone.joint);
    for (int j = 0; j < EDML_JOINTS; j++) {
        image[j].x = 500 + 1145 * (x[j].x + across) / (x[j].z + depth) + noise * gauss(r);
        image[j].y = 500 + 1145 * x[j].y / (x[j].z + depth) + noise * gauss(r);
        image[j].c = uniform(r, 0.1F, 1);
    }
    TEST_ASSERT_EQUAL_INT(EDML_OK, set_up_scene(&v, &someone, image, &camera));
    const matrix3 in_camera_axes = {{(float)turn.at[0][0], (float)turn.at[0][1], (float)turn.at[0][2]},
                                    {(float)turn.at[1][0], (float)turn.at[1][1], (float)turn.at[1][2]},
                                    {(float)turn.at[2][0], (float)turn.at[2][1], (float)turn.at[2][2]}};
    truth = compose(&v.view_rotation, &in_camera_axes);
    place_of_truth = (point){across, 0, depth};
    return v;
}

static matrix3 random_axes(rng *r)
{
    const point v = {gauss(r), gauss(r), gauss(r)};
    const float w = gauss(r), size = sqrtf(w * w + dot(v, v));
    return quaternion_rotation(w / size, over(v, size));
}

static float off_by(const matrix3 *a, const matrix3 *b) /* radians, when small */
{
    const float x = norm(minus(a->x, b->x)), y = norm(minus(a->y, b->y)), z = norm(minus(a->z, b->z));
    return sqrtf((x * x + y * y + z * z) / 2);
}

/* ---- Absolute orientation ------------------------------------------------------------------------ */

static void the_best_rotation_is_the_one_that_made_the_points(void)
{
    rng r = rng_seed(91);
    for (int n = 0; n < 200; n++) {
        const matrix3 turn = random_axes(&r);
        matrix3 m = zero_matrix, found;
        for (int j = 0; j < EDML_JOINTS; j++) {
            const point p = {gauss(&r), gauss(&r), n % 2 ? 0 : gauss(&r)}; /* flat ones, too */
            add_product(&m, rotate(&turn, p), p);
        }
        TEST_ASSERT_TRUE(nearest_rotation(&found, &m));
        TEST_ASSERT_ERROR_UP_TO(STEP_ROTATION, off_by(&found, &turn));
    }
}

/* Also where the points are nearer to a mirror image: no rotation nearby has a larger trace. */
static void the_best_rotation_is_a_rotation_and_the_best(void)
{
    rng r = rng_seed(92);
    for (int n = 0; n < 200; n++) {
        const matrix3 m = {{gauss(&r), gauss(&r), gauss(&r)},
                           {gauss(&r), gauss(&r), gauss(&r)},
                           {gauss(&r), gauss(&r), gauss(&r)}};
        matrix3 found;
        TEST_ASSERT_TRUE(nearest_rotation(&found, &m));
        TEST_ASSERT_ERROR_UP_TO(STEP_ROTATION, dot(cross(found.x, found.y), found.z) - 1);
        const float best = dot(found.x, m.x) + dot(found.y, m.y) + dot(found.z, m.z);
        for (int k = 0; k < 50; k++) {
            const matrix3 other = random_axes(&r);
            const point little = {0.1F * gauss(&r), 0.1F * gauss(&r), 0.1F * gauss(&r)};
            const matrix3 nudge = quaternion_rotation(1, little), near = compose(&nudge, &found);
            TEST_ASSERT_TRUE(dot(other.x, m.x) + dot(other.y, m.y) + dot(other.z, m.z) < best + STEP_TRACE);
            TEST_ASSERT_TRUE(dot(near.x, m.x) + dot(near.y, m.y) + dot(near.z, m.z) < best + STEP_TRACE);
        }
    }
}

/* ---- Orthogonal iteration -------------------------------------------------------------------------- */

static void alternating_never_raises_the_error_in_space(void)
{
    rng r = rng_seed(93);
    for (int n = 0; n < 300; n++) {
        const scene v = random_view(&r, n % 3 == 0 ? 0 : 10);
        estimate s, next;
        s.rotation = random_axes(&r);
        if (!best_translation(&s, &v)) continue; /* behind the camera */
        for (int k = 0; k < 50; k++) {
            const float before = s.error;
            next = s;
            if (!orthogonal_iteration_step(&next, &v, &s)) { /* at the minimum, or behind the camera */
                TEST_ASSERT_TRUE(next.translation.z <= 0 ||
                                 next.error < before * (1 + STEP_ERROR) + 1e-12F);
                break;
            }
            TEST_ASSERT_TRUE(next.error < before);
            s = next;
        }
    }
}

/* The place for a rotation has the least error: none nearby has less. */
static void places_are_the_best_for_their_rotation(void)
{
    rng r = rng_seed(94);
    for (int n = 0; n < 100; n++) {
        const scene v = random_view(&r, 10);
        estimate s, other;
        s.rotation = random_axes(&r);
        if (!best_translation(&s, &v)) continue;
        for (int k = 0; k < 20; k++) {
            const point aside = {0.05F * gauss(&r), 0.05F * gauss(&r), 0.05F * gauss(&r)};
            other = s;
            other.translation = plus(s.translation, aside);
            TEST_ASSERT_TRUE(!sum_errors(&other, &v, line_residual) || other.error > s.error);
        }
    }
}

/* Newton's steps and leaps included: the same minimum as that of hundreds of alternations. */
static void descending_ends_where_alternating_does(void)
{
    rng r = rng_seed(95);
    long plain = 0, quick = 0;
    for (int n = 0; n < 200; n++) {
        const scene v = random_view(&r, 5);
        estimate s, slow, next;
        TEST_ASSERT_TRUE(orthographic_start(&s, &v) && best_translation(&s, &v));
        slow = s;
        const float before = s.error;
        const int steps = object_space_descent(&s, &v);
        TEST_ASSERT_TRUE(steps >= 0 && steps <= MAX_STEPS && s.error <= before);
        int k = 0;
        for (; k < 5000 && orthogonal_iteration_step(&next, &v, &slow) &&
               next.error < slow.error * (1 - 1e-6F);
             k++)
            slow = next;
        plain += k;
        quick += steps;
        TEST_ASSERT_TRUE(s.error < slow.error * 1.001F);
    }
    printf("camera: %ld steps by alternation alone, %ld with Newton's\n", plain / 200, quick / 200);
    TEST_ASSERT_TRUE(quick * 5 < plain);
}

static void the_start_is_near_and_the_reversed_one_is_not(void)
{
    rng r = rng_seed(96);
    int near = 0;
    for (int n = 0; n < 200; n++) {
        const scene v = random_view(&r, 0);
        estimate s, reversed;
        TEST_ASSERT_TRUE(orthographic_start(&s, &v));
        near += off_by(&s.rotation, &truth) < 0.5F;
        TEST_ASSERT_TRUE(reversed_start(&reversed, &v, &s));
        TEST_ASSERT_TRUE(off_by(&reversed.rotation, &s.rotation) > 1e-4F ||
                         off_by(&s.rotation, &truth) > 0.5F);
    }
    TEST_ASSERT_TRUE(near > 190);
}

/* The better of what the iteration makes of a estimate and of its reversed; 0 if both lead nowhere. */
static int descend_both_ways(estimate *s, const scene *v)
{
    estimate reversed;
    const int first = object_space_descent(s, v);
    const int second = reversed_start(&reversed, v, s) ? object_space_descent(&reversed, v) : -1;
    if (second >= 0 && (first < 0 || reversed.error < s->error)) *s = reversed;
    return first >= 0 || second >= 0;
}

static int is_found(const estimate *s, const scene *v)
{
    edml_placement out;
    if (write_placement(&out, v, s, &someone, &camera, 0) != EDML_OK) return 0;
    return off_by(&s->rotation, &truth) < 0.0017F /* 0.1 degrees */ &&
           norm(minus(out.translation, place_of_truth)) < 0.001F * norm(place_of_truth);
}

/* Without the closed form: of random rotations that leave the person in front of the camera, one leads
 * to the truth but for some in a hundred, which walk behind the camera or end elsewhere.  So of four the
 * least error is always the truth's. */
static void random_starts_lead_to_the_truth(void)
{
    rng r = rng_seed(97);
    int alone = 0;
    for (int n = 0; n < 1000; n++) {
        const scene v = random_view(&r, 0);
        estimate best = {0};
        for (int tried = 0; tried < 4;) {
            estimate s;
            s.rotation = random_axes(&r);
            if (!best_translation(&s, &v)) continue;
            const int led = descend_both_ways(&s, &v);
            if (tried++ == 0) alone += led && is_found(&s, &v);
            if (led && (!(best.translation.z > 0) || s.error < best.error)) best = s;
        }
        TEST_ASSERT_TRUE(is_found(&best, &v));
    }
    printf("camera: %d of 1000 found from one random rotation, all from four\n", alone);
    TEST_ASSERT_TRUE(alone >= 900);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_best_rotation_is_the_one_that_made_the_points);
    RUN_TEST(the_best_rotation_is_a_rotation_and_the_best);
    RUN_TEST(alternating_never_raises_the_error_in_space);
    RUN_TEST(places_are_the_best_for_their_rotation);
    RUN_TEST(descending_ends_where_alternating_does);
    RUN_TEST(the_start_is_near_and_the_reversed_one_is_not);
    RUN_TEST(random_starts_lead_to_the_truth);
    return UNITY_END();
}
