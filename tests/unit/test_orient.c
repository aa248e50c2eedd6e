/* lift/orient.h: turned to the image, about the mean.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "as_float.h"

static edml_point person[EDML_JOINTS], x[EDML_JOINTS], y[EDML_JOINTS];
static edml_image image;
static float distance[EDML_PAIRS];

static edml_point random_shift(rng *r)
{
    const edml_point shift = {uniform(r, -1, 1), uniform(r, -1, 1), uniform(r, -1, 1)};
    return shift;
}

/* Part of the points' spread that lies along their thinnest axis.  The ridge of orient.h adds
 * 0.01 to it, and so turns thin bodies too little: the thinner, the more. */
static float thinness(const edml_point p[EDML_JOINTS])
{
    edml_point axes[EDML_JOINTS];
    edml_work work;
    float d[EDML_PAIRS], thin = 0, all = 0;
    pair_distances(d, p);
    edml_mds(axes, d, &work); /* z: the thinnest */
    for (int j = 0; j < EDML_JOINTS; j++) {
        thin += axes[j].z * axes[j].z;
        all += axes[j].x * axes[j].x + axes[j].y * axes[j].y + axes[j].z * axes[j].z;
    }
    return thin / all;
}

static void root_at_mean(edml_point p[EDML_JOINTS])
{
    edml_point mean = {0, 0, 0};
    for (int j = 0; j < EDML_JOINTS; j++) {
        mean.x += p[j].x / EDML_JOINTS;
        mean.y += p[j].y / EDML_JOINTS;
        mean.z += p[j].z / EDML_JOINTS;
    }
    for (int j = 0; j < EDML_JOINTS; j++) {
        p[j].x -= mean.x;
        p[j].y -= mean.y;
        p[j].z -= mean.z;
    }
}

/* Turns and moves the person as MDS would, draws it, and runs. */
static void turn_and_run(rng *r, uint16_t seen)
{
    draw_image(&image, person, seen);
    rotate_points(x, random_rotation(r), person);
    const edml_point shift = random_shift(r);
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j].x += shift.x;
        x[j].y += shift.y;
        x[j].z += shift.z;
        if (!(seen >> j & 1)) image.at[j].u = image.at[j].v = NAN;
    }
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_orient(x, &image));
}

/* Worst joint over people from `thin` to twice as thick. */
static float worst_over_people(void (*make)(rng *), float thin, uint16_t seen, int count)
{
    rng r = rng_seed(51);
    float worst = 0;
    for (int n = 0; n < count;) {
        make(&r);
        root_at_mean(person);
        if (thinness(person) < thin || thinness(person) > 2 * thin) continue;
        n++;
        turn_and_run(&r, seen);
        const float error = worst_joint_error(x, person);
        worst = worse(worst, error);
    }
    return worst;
}

static void make_human(rng *r) { random_human(r, person); }
static void make_cloud(rng *r) { random_points(r, person, 0.8F); }

static void people_come_back_as_photographed(void)
{
    static const float thin[] = {0.01F, 0.02F, 0.04F, 0.08F};
    static const float tolerance[] = ORIENT_PERSON_TOLERANCES;
    for (int n = 0; n < 4; n++) {
        const float worst = worst_over_people(make_human, thin[n], ALL_SEEN, 300);
        printf("orient: people with %.0f to %.0f %% of their spread in depth, worst joint %.1f mm\n",
               1e2 * (double)thin[n], 2e2 * (double)thin[n], 1e3 * (double)worst);
        TEST_ASSERT_ERROR_UP_TO(tolerance[n], worst);
    }
}

static void clouds_of_points_come_back_as_photographed(void)
{
    const float worst = worst_over_people(make_cloud, 0.16F, ALL_SEEN, 300);
    printf("orient: clouds of points, worst joint %.1f mm\n", 1e3 * (double)worst);
    TEST_ASSERT_ERROR_UP_TO(ORIENT_CLOUD_TOLERANCE, worst);
}

/* Corners of a cube and more on its axes: ridges add the same to each axis, and have no effect. */
static void points_spread_evenly_come_back_to_rounding(void)
{
    rng r = rng_seed(52);
    for (int n = 0; n < 8; n++) {
        person[n].x = n & 1 ? 0.5F : -0.5F;
        person[n].y = n & 2 ? 0.5F : -0.5F;
        person[n].z = n & 4 ? 0.5F : -0.5F;
    }
    static const edml_point axes[] = {{.7F, 0, 0},  {-.7F, 0, 0}, {0, .7F, 0},
                                      {0, -.7F, 0}, {0, 0, .7F},  {0, 0, -.7F}};
    memcpy(person + 8, axes, sizeof axes);
    root_at_mean(person);
    for (int n = 0; n < 50; n++) {
        turn_and_run(&r, ALL_SEEN);
        TEST_ASSERT_ERROR_UP_TO(ORIENT_EVEN_TOLERANCE, worst_joint_error(x, person));
    }
}

static void joints_that_were_not_seen_come_along(void)
{
    const uint16_t seen = ALL_SEEN & ~(1 << EDML_R_WRIST) & ~(1 << EDML_L_ANKLE);
    const float worst = worst_over_people(make_human, 0.04F, seen, 300);
    TEST_ASSERT_ERROR_UP_TO(ORIENT_UNSEEN_TOLERANCE, worst);
}

static void four_joints_are_enough_for_a_proper_rotation(void)
{
    rng r = rng_seed(53);
    human_pose(person);
    root_at_mean(person);
    pair_distances(distance, person);
    turn_and_run(&r, 1 << EDML_HEAD | 1 << EDML_R_ELBOW | 1 << EDML_L_WRIST | 1 << EDML_R_ANKLE);
    TEST_ASSERT_ERROR_UP_TO(ROUNDING, worst_distance_error(x, distance));
    TEST_ASSERT_TRUE(same_handedness(x, person));
}

/* ---- What must hold for every input -------------------------------------------------------------- */

static void the_mean_is_the_origin(void)
{
    rng r = rng_seed(54);
    for (int n = 0; n < 50; n++) {
        random_human(&r, person);
        turn_and_run(&r, ALL_SEEN);
        memcpy(y, x, sizeof y);
        root_at_mean(y);
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, worst_joint_error(x, y));
    }
}

/* Whatever the image shows: distances are kept and the mirror image is not taken. */
static void it_is_a_rotation_whatever_the_image(void)
{
    rng r = rng_seed(55);
    for (int n = 0; n < 300; n++) {
        random_human(&r, person);
        pair_distances(distance, person);
        memcpy(x, person, sizeof x);
        draw_image(&image, person, ALL_SEEN);
        for (int j = 0; j < EDML_JOINTS; j++) {
            image.at[j].u = uniform(&r, -3.5F, 3.5F);
            image.at[j].v = uniform(&r, -1, 1);
        }
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_orient(x, &image));
        TEST_ASSERT_ERROR_UP_TO(ROUNDING, worst_distance_error(x, distance));
        TEST_ASSERT_TRUE(same_handedness(x, person));
    }
}

static void the_frame_of_the_points_does_not_matter(void)
{
    rng r = rng_seed(56);
    for (int n = 0; n < 100; n++) {
        random_human(&r, person);
        turn_and_run(&r, ALL_SEEN);
        memcpy(y, x, sizeof y);
        turn_and_run(&r, ALL_SEEN);
        TEST_ASSERT_ERROR_UP_TO(ORIENT_FRAME_TOLERANCE, worst_joint_error(x, y));
    }
}

static void size_and_place_of_the_image_do_not_matter(void)
{
    rng r = rng_seed(57);
    for (int n = 0; n < 100; n++) {
        random_human(&r, person);
        draw_image(&image, person, ALL_SEEN);
        rotate_points(x, random_rotation(&r), person);
        memcpy(y, x, sizeof y);
        edml_orient(x, &image);
        for (int j = 0; j < EDML_JOINTS; j++) {
            image.at[j].u = 0.77F * image.at[j].u - 1;
            image.at[j].v = 0.77F * image.at[j].v + 0.5F;
        }
        edml_orient(y, &image);
        TEST_ASSERT_ERROR_UP_TO(ORIENT_FRAME_TOLERANCE, worst_joint_error(x, y));
    }
}

static void turning_the_image_turns_the_pose(void)
{
    rng r = rng_seed(58);
    random_human(&r, person);
    turn_and_run(&r, ALL_SEEN);
    memcpy(y, x, sizeof y);
    for (int j = 0; j < EDML_JOINTS; j++) { /* a quarter turn: x to y, y to -x */
        const float was = image.at[j].u;
        image.at[j].u = -image.at[j].v;
        image.at[j].v = was;
        const edml_point turned = {-y[j].y, y[j].x, y[j].z};
        y[j] = turned;
    }
    edml_orient(x, &image);
    TEST_ASSERT_ERROR_UP_TO(ORIENT_FRAME_TOLERANCE, worst_joint_error(x, y));
}

/* The points come in the image's axes, whichever way it was turned from the camera's. */
static void where_down_was_does_not_matter(void)
{
    rng r = rng_seed(61);
    random_human(&r, person);
    draw_image(&image, person, ALL_SEEN);
    memcpy(x, person, sizeof x);
    memcpy(y, person, sizeof y);
    edml_orient(x, &image);
    image.down.u = image.down.v = 0.6F;
    edml_orient(y, &image);
    TEST_ASSERT_EQUAL_MEMORY(x, y, sizeof x);
}

/* ---- Where there is no answer -------------------------------------------------------------------- */

static void check_refused(uint16_t seen)
{
    image.seen = seen;
    memcpy(y, x, sizeof y);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, edml_orient(x, &image));
    TEST_ASSERT_EQUAL_MEMORY(y, x, sizeof y);
}

static void a_collinear_image_is_refused(void)
{
    rng r = rng_seed(59);
    for (int n = 0; n < 100; n++) {
        random_human(&r, person);
        memcpy(x, person, sizeof x);
        draw_image(&image, person, ALL_SEEN);
        const float slope = n % 3 == 0 ? 0 : uniform(&r, -3, 3);
        for (int j = 0; j < EDML_JOINTS; j++) image.at[j].u = slope * image.at[j].v;
        check_refused(ALL_SEEN);
    }
}

static void an_image_without_height_or_extent_is_refused(void)
{
    human_pose(x);
    draw_image(&image, x, ALL_SEEN);
    for (int j = 0; j < EDML_JOINTS; j++) image.at[j].v = 0.5F;
    check_refused(ALL_SEEN);
    for (int j = 0; j < EDML_JOINTS; j++) image.at[j].u = -1;
    check_refused(ALL_SEEN);
    for (int j = 0; j < EDML_JOINTS; j++) image.at[j].u = image.at[j].v = 0;
    check_refused(ALL_SEEN);
}

static void equal_points_and_no_joints_are_refused(void)
{
    human_pose(x);
    draw_image(&image, x, ALL_SEEN);
    check_refused(0);
    check_refused((uint16_t)~ALL_SEEN);
    equal_points(x, 1, 2, 3);
    check_refused(ALL_SEEN);
}

static void bits_beyond_the_joints_do_not_count(void)
{
    human_pose(x);
    draw_image(&image, x, ALL_SEEN);
    memcpy(y, x, sizeof y);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_orient(x, &image));
    image.seen = 0xFFFF;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_orient(y, &image));
    TEST_ASSERT_EQUAL_MEMORY(x, y, sizeof x);
}

/* Points along x, at the corners of a square in the image: neither says where the other is. */
static void points_that_have_nothing_to_do_with_the_image_are_refused(void)
{
    equal_points(x, 0, 0, 0);
    memset(&image, 0, sizeof image);
    for (int j = 0; j < 4; j++) {
        x[j].x = j % 2 ? 1 : -1;
        image.at[j].u = image.at[j].v = j / 2 ? 1 : -1;
    }
    check_refused(ALL_SEEN);
}

/* MDS of a network's output may be that flat. */
static void points_in_a_plane_keep_their_shape_those_on_a_line_are_refused(void)
{
    rng r = rng_seed(60);
    human_pose(person);
    draw_image(&image, person, ALL_SEEN);
    for (int j = 0; j < EDML_JOINTS; j++) person[j].z = 0;
    pair_distances(distance, person);
    rotate_points(x, random_rotation(&r), person);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_orient(x, &image));
    TEST_ASSERT_ERROR_UP_TO(ROUNDING, worst_distance_error(x, distance));
    for (int j = 0; j < EDML_JOINTS; j++) person[j].x = 0;
    rotate_points(x, random_rotation(&r), person);
    check_refused(ALL_SEEN);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(people_come_back_as_photographed);
    RUN_TEST(clouds_of_points_come_back_as_photographed);
    RUN_TEST(points_spread_evenly_come_back_to_rounding);
    RUN_TEST(joints_that_were_not_seen_come_along);
    RUN_TEST(four_joints_are_enough_for_a_proper_rotation);
    RUN_TEST(the_mean_is_the_origin);
    RUN_TEST(it_is_a_rotation_whatever_the_image);
    RUN_TEST(the_frame_of_the_points_does_not_matter);
    RUN_TEST(size_and_place_of_the_image_do_not_matter);
    RUN_TEST(turning_the_image_turns_the_pose);
    RUN_TEST(where_down_was_does_not_matter);
    RUN_TEST(a_collinear_image_is_refused);
    RUN_TEST(an_image_without_height_or_extent_is_refused);
    RUN_TEST(equal_points_and_no_joints_are_refused);
    RUN_TEST(points_that_have_nothing_to_do_with_the_image_are_refused);
    RUN_TEST(bits_beyond_the_joints_do_not_count);
    RUN_TEST(points_in_a_plane_keep_their_shape_those_on_a_line_are_refused);
    return UNITY_END();
}
