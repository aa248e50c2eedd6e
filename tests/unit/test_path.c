/* optional/camera/path: where a person goes, filtered.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "as_float.h"

enum { FRAME_MS = 33 };

static edml_path path;
static edml_placement placement;

static edml_point point_of(float x, float y, float z)
{
    const edml_point p = {x, y, z};
    return p;
}

static edml_point moved(edml_point from, float seconds, edml_point rate)
{
    return point_of(from.x + seconds * rate.x, from.y + seconds * rate.y, from.z + seconds * rate.z);
}

/* A placement with mid-hip there, and joints around it. */
static void place_at(edml_point at)
{
    memset(&placement, 0, sizeof placement);
    human_pose(placement.joint);
    root_at_mid_hip(placement.joint);
    for (int j = 0; j < EDML_JOINTS; j++) placement.joint[j] = moved(at, 1, placement.joint[j]);
    placement.translation = at;
    placement.rotation[0].x = placement.rotation[1].y = placement.rotation[2].z = 1;
    placement.reprojection = 2.5F;
    placement.steps = 7;
}

static edml_point follow(edml_point at, uint32_t time_ms)
{
    place_at(at);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_path_follow(&path, &placement, time_ms));
    return placement.translation;
}

/* ---- What is filtered --------------------------------------------------------------------------- */

static void the_first_placement_stays_where_it_is(void)
{
    const edml_point at = {1, -0.25F, 4};
    edml_path_start(&path);
    const edml_point found = follow(at, 12345);
    TEST_ASSERT_ERROR_UP_TO(1e-4F, (float)distance_between(at, found));
    TEST_ASSERT_EQUAL_INT(1, path.placements);
}

/* Whatever the rate and the steps in time: no lag. */
static void a_straight_way_at_an_even_pace_is_left_alone(void)
{
    rng r = rng_seed(201);
    for (int n = 0; n < 50; n++) {
        const edml_point from = {uniform(&r, -2, 2), uniform(&r, -1, 1), uniform(&r, 3, 12)};
        const edml_point rate = {uniform(&r, -2, 2), uniform(&r, -0.5F, 0.5F), uniform(&r, -0.5F, 2)};
        uint32_t time = rng_bits(&r);
        float seconds = 0;
        edml_path_start(&path);
        for (int frame = 0; frame < 60; frame++) {
            const uint32_t step = n % 2 ? FRAME_MS : 16 + rng_bits(&r) % 100;
            const edml_point at = moved(from, seconds, rate), found = follow(at, time);
            TEST_ASSERT_ERROR_UP_TO(PATH_TOLERANCE, (float)distance_between(at, found));
            time += step;
            seconds += 0.001F * (float)step;
        }
        TEST_ASSERT_ERROR_UP_TO(PATH_RATE_TOLERANCE, (float)distance_between(rate, path.rate));
    }
}

/* Someone stands, or walks away, and is found at distances that are off by 2 %. */
static void noise_in_depth_is_taken_out(void)
{
    rng r = rng_seed(202);
    for (int n = 0; n < 20; n++) {
        const edml_point from = {uniform(&r, -1, 1), 0, uniform(&r, 3, 6)};
        const edml_point rate = {0, 0, n % 2 ? 1.2F : 0};
        double before = 0, after = 0;
        edml_path_start(&path);
        for (uint32_t frame = 0; frame < 120; frame++) {
            const edml_point truth = moved(from, 0.001F * FRAME_MS * (float)frame, rate);
            const float factor = 1 + 0.02F * gauss(&r);
            const edml_point seen = {factor * truth.x, factor * truth.y, factor * truth.z};
            const edml_point found = follow(seen, frame * FRAME_MS);
            if (frame < 30) continue;
            before += distance_between(truth, seen);
            after += distance_between(truth, found);
        }
        TEST_ASSERT_TRUE(after < 0.55 * before);
    }
}

/* The same acceleration, along the line of sight and across it: what a step to the side needs is there after
 * three frames. */
static void motion_across_the_line_of_sight_is_followed_at_once(void)
{
    float lag[2];
    for (int across = 0; across < 2; across++) {
        const edml_point to = across ? point_of(0.15F, 0, 4) : point_of(0, 0, 4.15F);
        edml_path_start(&path);
        uint32_t time = 0;
        for (int frame = 0; frame < 60; frame++) follow(point_of(0, 0, 4), time += FRAME_MS);
        for (int frame = 0; frame < 2; frame++) follow(to, time += FRAME_MS);
        lag[across] = (float)distance_between(to, follow(to, time + FRAME_MS));
    }
    printf("path: three frames after a step of 150 mm, %.0f mm behind across, %.0f mm along\n",
           (double)(1000 * lag[1]), (double)(1000 * lag[0]));
    TEST_ASSERT_TRUE(lag[1] < 0.03F);
    TEST_ASSERT_TRUE(lag[0] > 0.06F);
}

static void all_joints_move_alike_and_nothing_else_changes(void)
{
    edml_path_start(&path);
    for (uint32_t frame = 0; frame < 20; frame++) follow(point_of(0, 0, 4), frame * FRAME_MS);
    const edml_point seen = {0.05F, 0.02F, 4.25F};
    place_at(seen);
    edml_placement before = placement;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_path_follow(&path, &placement, 20 * FRAME_MS));
    TEST_ASSERT_TRUE(distance_between(placement.translation, seen) > 0.05);
    TEST_ASSERT_TRUE(distance_between(placement.translation, path.at) < 1e-6);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_point a = placement.joint[j], b = before.joint[j];
        TEST_ASSERT_FLOAT_WITHIN(1e-4F, placement.translation.x - seen.x, a.x - b.x);
        TEST_ASSERT_FLOAT_WITHIN(1e-4F, placement.translation.y - seen.y, a.y - b.y);
        TEST_ASSERT_FLOAT_WITHIN(1e-4F, placement.translation.z - seen.z, a.z - b.z);
    }
    TEST_ASSERT_EQUAL_MEMORY(before.rotation, placement.rotation, sizeof before.rotation);
    TEST_ASSERT_TRUE(placement.reprojection == before.reprojection && placement.steps == before.steps);
}

#ifndef EDML_TEST_Q24 /* which rounds places to 2^-16 m */
typedef struct {
    double place, rate;
} gains;

/* A fading memory keeps `left` of what was; in the steady state it follows from Kalata's index, and the first
 * placements are on a line of least squares. */
static gains gains_for(double acceleration_over_noise, double seconds, double distance, int n)
{
    const double root = fmin(acceleration_over_noise * seconds / sqrt(distance), 4), index = root * root;
    const double left = (4 + index - sqrt(8 * index + index * index)) / 4;
    const gains line = {2.0 * (2 * n - 1) / (n * (n + 1)), 6.0 / (n * (n + 1))};
    gains made = {fmax(1 - left * left, line.place), fmax((1 - left) * (1 - left), line.rate)};
    if (n == 2) made.rate = line.rate;
    return made;
}

static double at_most(double most, double value) { return fmax(-most, fmin(most, value)); }

/* What a path must have made of a placement after the last one. */
static void check_followed(const edml_path *before, edml_point to, double seconds)
{
    const double seen[] = {(double)to.x, (double)to.y, (double)to.z};
    const double at[] = {(double)before->at.x, (double)before->at.y, (double)before->at.z};
    const double rate[] = {(double)before->rate.x, (double)before->rate.y, (double)before->rate.z};
    const float found[] = {path.at.x, path.at.y, path.at.z};
    const float rates[] = {path.rate.x, path.rate.y, path.rate.z};
    const double distance = sqrt(seen[0] * seen[0] + seen[1] * seen[1] + seen[2] * seen[2]);
    double expected[3], along = 0;
    int leapt = 0;
    for (int k = 0; k < 3; k++) {
        expected[k] = at_most(100, at[k] + seconds * rate[k]);
        along += (seen[k] - expected[k]) * seen[k] / distance;
        leapt |= fabs(seen[k] - expected[k]) > fmin(distance / 3, 15);
    }
    TEST_ASSERT_EQUAL_INT(leapt ? 1 : before->placements + 1, path.placements);
    const gains a = gains_for(10, seconds, fmax(distance, 1), path.placements);
    const gains c = gains_for(100, seconds, fmax(distance, 1), path.placements);
    for (int k = 0; k < 3; k++) {
        const double news_along = along * seen[k] / distance,
                     news_across = seen[k] - expected[k] - news_along;
        const double more = (a.rate * news_along + c.rate * news_across) / seconds;
        const double place = at_most(100, expected[k] + a.place * news_along + c.place * news_across);
        const double quicker = at_most(24, rate[k] + at_most(24, more));
        TEST_ASSERT_FLOAT_WITHIN(2e-5F * (float)(1 + distance), (float)(leapt ? seen[k] : place), found[k]);
        TEST_ASSERT_FLOAT_WITHIN(1e-3F * (float)(1 + distance), (float)(leapt ? 0 : quicker), rates[k]);
    }
}

/* Near and far, at a few frames a second and at hundreds, with leaps and with absurd speeds. */
static void a_placement_is_followed_by_its_distance_and_the_time(void)
{
    rng r = rng_seed(204);
    int leaps = 0, fastest = 0;
    for (int n = 0; n < 300; n++) {
        static const uint32_t ms[] = {1, 16, 33, 100, 400, 1000};
        const float depth = n % 4 == 0 ? uniform(&r, 0.3F, 1) : uniform(&r, 1, n % 4 == 1 ? 90 : 6);
        const float off = n % 3 == 0 ? 0.005F : n % 3 == 1 ? 0.05F : 0.2F;
        const edml_point from = {depth * uniform(&r, -1, 1), depth * uniform(&r, -0.5F, 0.5F), depth};
        uint32_t time = rng_bits(&r);
        edml_path_start(&path);
        for (int k = 0; k < 30; k++) {
            const edml_point aside = {off * depth * gauss(&r), off * depth * gauss(&r),
                                      off * depth * gauss(&r)};
            edml_point to = moved(from, 1, aside);
            if (to.z < 0.1F) to.z = 0.1F;
            if (fabsf(to.x) > 99 || fabsf(to.y) > 99 || to.z > 99) continue;
            const edml_path before = path;
            const uint32_t step = ms[(n + k / 10) % 6];
            follow(to, time += step);
            if (before.placements > 0) check_followed(&before, to, step / 1000.0);
            leaps += before.placements > 1 && path.placements == 1;
            fastest += fabsf(path.rate.x) == 24;
        }
    }
    TEST_ASSERT_TRUE(leaps > 50 && fastest > 50);
}

static void the_memory_of_a_path_ends_at_a_thousand_placements(void)
{
    edml_path_start(&path);
    for (uint32_t n = 1; n <= 1005; n++) {
        follow(point_of(0, 0, 4), n);
        TEST_ASSERT_EQUAL_INT(n < 1000 ? n : 1000, path.placements);
    }
}

static void a_path_that_starts_anew_stands_still(void)
{
    edml_path_start(&path);
    for (uint32_t n = 0; n < 10; n++) follow(point_of(0.1F * (float)n, 0, 4), 33 * n);
    TEST_ASSERT_TRUE(path.rate.x > 1);
    follow(point_of(0, 0, 9), 330);
    TEST_ASSERT_TRUE(path.rate.x == 0 && path.rate.y == 0 && path.rate.z == 0);
}
#endif

/* ---- Starts, gaps and leaps --------------------------------------------------------------------- */

/* A path that is steady at 4 m; returns the time of its last frame. */
static uint32_t steady_path(void)
{
    uint32_t time = 4294967000U; /* wraps around on the way */
    edml_path_start(&path);
    for (int frame = 0; frame < 30; frame++) follow(point_of(0, 0, 4), time += FRAME_MS);
    return time;
}

static void it_starts_anew_after_a_second_without_a_placement(void)
{
    const edml_point there = {0, 0, 4.5F};
    uint32_t time = steady_path();
    follow(there, time + 1000);
    TEST_ASSERT_EQUAL_INT(31, path.placements);
    time = steady_path();
    TEST_ASSERT_ERROR_UP_TO(1e-4F, (float)distance_between(there, follow(there, time + 1001)));
    TEST_ASSERT_EQUAL_INT(1, path.placements);
}

static void it_starts_anew_with_somebody_else(void)
{
    static const edml_point others[] = {{0, 0, 7}, {2.6F, 0, 4}, {-2.6F, 0, 4}, {0, 0, 2}};
    for (int n = 0; n < 4; n++) {
        const uint32_t time = steady_path();
        const edml_point found = follow(others[n], time + FRAME_MS);
        TEST_ASSERT_ERROR_UP_TO(1e-4F, (float)distance_between(others[n], found));
        TEST_ASSERT_EQUAL_INT(1, path.placements);
    }
    const uint32_t time = steady_path();
    follow(point_of(0, 0, 4.8F), time + FRAME_MS); /* a bad frame of the same person */
    TEST_ASSERT_EQUAL_INT(31, path.placements);
}

static void expect(edml_status status, uint32_t time_ms)
{
    const edml_path before = path;
    edml_placement untouched = placement;
    TEST_ASSERT_EQUAL_INT(status, edml_path_follow(&path, &placement, time_ms));
    TEST_ASSERT_SAME_BYTES(before, path);
    TEST_ASSERT_SAME_BYTES(untouched, placement);
}

static void time_goes_on(void)
{
    const uint32_t time = steady_path();
    place_at(point_of(0, 0, 4));
    expect(EDML_ERR_TIME, time);
    expect(EDML_ERR_TIME, time - 1);
    expect(EDML_ERR_TIME, time + 0x80000001U);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_path_follow(&path, &placement, time + 1));
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_path_follow(&path, &placement, time + 1 + UINT32_MAX / 2));
}

static void a_placement_that_is_none_is_refused(void)
{
    static const float wrong[] = {NAN, INFINITY, -INFINITY, 121, -121};
    const uint32_t time = steady_path() + FRAME_MS;
    for (int n = 0; n < 5; n++) {
        place_at(point_of(0, 0, 4));
        placement.translation.x = wrong[n];
        expect(EDML_ERR_NOT_FINITE, time);
        for (int j = 0; j < EDML_JOINTS; j++) {
            place_at(point_of(0, 0, 4));
            placement.joint[j].z = wrong[n];
            expect(EDML_ERR_NOT_FINITE, time);
        }
    }
    place_at(point_of(0, 0, 101));
    expect(EDML_ERR_CAMERA, time);
    place_at(point_of(0, -101, 50));
    expect(EDML_ERR_CAMERA, time);
    place_at(point_of(0, 0, -4));
    expect(EDML_ERR_CAMERA, time);
    place_at(point_of(1, 0, 0));
    expect(EDML_ERR_CAMERA, time);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_path_follow(NULL, &placement, time));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT, edml_path_follow(&path, NULL, time));
}

/* Anywhere in reach, at any rate of frames: finite, and never far from what is seen. */
static void whatever_is_seen_the_path_stays_near(void)
{
    rng r = rng_seed(203);
    uint32_t time = 0;
    edml_path_start(&path);
    edml_point centre = {0, 0, 10};
    for (int n = 0; n < 5000; n++) {
        if (n % 100 == 0) {
            const float far = n % 300 == 0 ? 99 : 8;
            centre = point_of(uniform(&r, -far, far), uniform(&r, -far, far), uniform(&r, 0.5F, far));
        }
        const float off = n % 200 < 100 ? 0.3F : 3;
        const float z = centre.z + uniform(&r, -off, off);
        const edml_point at = {centre.x * 0.9F + uniform(&r, -off, off),
                               centre.y * 0.9F + uniform(&r, -off, off), z > 0.1F && z < 99 ? z : 0.5F};
        time += 1 + rng_bits(&r) % (n % 2 ? 20 : 600);
        const edml_point found = follow(at, time);
        TEST_ASSERT_TRUE(all_finite(&path.at, 6));
        TEST_ASSERT_TRUE(distance_between(found, at) < 26.5);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(the_first_placement_stays_where_it_is);
    RUN_TEST(a_straight_way_at_an_even_pace_is_left_alone);
    RUN_TEST(noise_in_depth_is_taken_out);
    RUN_TEST(motion_across_the_line_of_sight_is_followed_at_once);
    RUN_TEST(all_joints_move_alike_and_nothing_else_changes);
#ifndef EDML_TEST_Q24
    RUN_TEST(a_placement_is_followed_by_its_distance_and_the_time);
    RUN_TEST(the_memory_of_a_path_ends_at_a_thousand_placements);
    RUN_TEST(a_path_that_starts_anew_stands_still);
#endif
    RUN_TEST(it_starts_anew_after_a_second_without_a_placement);
    RUN_TEST(it_starts_anew_with_somebody_else);
    RUN_TEST(time_goes_on);
    RUN_TEST(a_placement_that_is_none_is_refused);
    RUN_TEST(whatever_is_seen_the_path_stays_near);
    return UNITY_END();
}
