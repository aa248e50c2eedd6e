/* optional/angles.h: angles of poses that are made at known ones.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>

#include "as_float.h"

enum { RIGHT, LEFT };
#define NONE NAN

static const double degree = 3.14159265358979323846 / 180;
static const edml_point level = {0, -1, 0};

static edml_pose pose;
static float found[EDML_ANGLES];

/* ---- Someone whose limbs are put where they are wanted ------------------------------------------------- */

static edml_point point_of(double x, double y, double z)
{
    const edml_point p = {(float)x, (float)y, (float)z};
    return p;
}

/* Stands before a level camera and faces it, arms hanging: x right, y down, z away. */
static void stand(void)
{
    static const edml_point standing[EDML_JOINTS] = {
        {0, -0.8F, 0},    {0, -0.5F, 0},     {-0.2F, -0.5F, 0}, {-0.2F, -0.25F, 0}, {-0.2F, 0, 0},
        {0.2F, -0.5F, 0}, {0.2F, -0.25F, 0}, {0.2F, 0, 0},      {-0.1F, 0, 0},      {-0.1F, 0.4F, 0},
        {-0.1F, 0.8F, 0}, {0.1F, 0, 0},      {0.1F, 0.4F, 0},   {0.1F, 0.8F, 0},
    };
    memset(&pose, 0, sizeof pose);
    memcpy(pose.joint, standing, sizeof standing);
    pose.seen = ALL_SEEN;
}

/* Turns the two bones behind a shoulder or a hip to a direction in the body's axes: forward, up, outward. */
static void point_limb(int first, double forward, double up, double outward)
{
    const double length = sqrt(forward * forward + up * up + outward * outward);
    const double side = first == EDML_R_SHOULDER || first == EDML_R_HIP ? -1 : 1;
    for (int n = 1; n <= 2; n++) {
        const double by = n * 0.25 / length;
        pose.joint[first + n].x = pose.joint[first].x + (float)(by * side * outward);
        pose.joint[first + n].y = pose.joint[first].y - (float)(by * up);
        pose.joint[first + n].z = pose.joint[first].z - (float)(by * forward);
    }
}

static void point_limbs(int right, int left, double forward, double up, double outward)
{
    point_limb(right, forward, up, outward);
    point_limb(left, forward, up, outward);
}

/* About an axis of the camera's, right-handed: x right, y down, z away. */
static rotation3 rotation_about(char axis, double degrees)
{
    const double c = cos(degrees * degree), s = sin(degrees * degree);
    const rotation3 x = {{{1, 0, 0}, {0, c, -s}, {0, s, c}}};
    const rotation3 y = {{{c, 0, s}, {0, 1, 0}, {-s, 0, c}}};
    const rotation3 z = {{{c, -s, 0}, {s, c, 0}, {0, 0, 1}}};
    return axis == 'x' ? x : axis == 'y' ? y : z;
}

static void turn(char axis, double degrees)
{
    rotate_points(pose.joint, rotation_about(axis, degrees), pose.joint);
}

static edml_point turned(edml_point p, rotation3 by)
{
    edml_point points[EDML_JOINTS];
    equal_points(points, p.x, p.y, p.z);
    rotate_points(points, by, points);
    return points[0];
}

static void measure(const edml_point *up)
{
    memset(found, 0x5A, sizeof found);
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_angles(found, &pose, up));
}

static void check_angle(int angle, float expected)
{
    if (isnan(expected))
        TEST_ASSERT_FLOAT_IS_NAN_MESSAGE(found[angle], edml_angle_name(angle));
    else
        TEST_ASSERT_FLOAT_WITHIN_MESSAGE(ANGLE_TOLERANCE, expected, found[angle], edml_angle_name(angle));
}

static void check_pair(int right, float expected)
{
    check_angle(right + RIGHT, expected);
    check_angle(right + LEFT, expected);
}

static void check_shoulders(float elevation, float plane, float flexion, float abduction)
{
    measure(NULL);
    check_pair(EDML_R_SHOULDER_ELEVATION, elevation);
    check_pair(EDML_R_SHOULDER_PLANE, plane);
    check_pair(EDML_R_SHOULDER_FLEXION, flexion);
    check_pair(EDML_R_SHOULDER_ABDUCTION, abduction);
}

static void check_hips(float flexion, float abduction)
{
    measure(NULL);
    check_pair(EDML_R_HIP_FLEXION, flexion);
    check_pair(EDML_R_HIP_ABDUCTION, abduction);
}

static void check_trunk(float lean, float forward, float right, float heading)
{
    measure(NULL);
    check_angle(EDML_TRUNK_LEAN, lean);
    check_angle(EDML_TRUNK_LEAN_FORWARD, forward);
    check_angle(EDML_TRUNK_LEAN_RIGHT, right);
    check_angle(EDML_HEADING, heading);
}

/* ---- Known poses ----------------------------------------------------------------------------------------- */

static void who_stands_has_zero_everywhere(void)
{
    stand();
    measure(NULL);
    for (int n = 0; n < EDML_ANGLES; n++) check_angle(n, n / 2 == EDML_R_SHOULDER_PLANE / 2 ? NONE : 0);
}

static void arms_held_out_as_a_t(void)
{
    stand();
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, 0, 0, 1);
    check_shoulders(90, 0, NONE, 90);
    check_pair(EDML_R_ELBOW_FLEXION, 0);
}

static void arms_raised_forward(void)
{
    stand();
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, 1, 0, 0);
    check_shoulders(90, 90, 90, NONE);
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, sin(30 * degree), -cos(30 * degree), 0);
    check_shoulders(30, 90, 30, 0);
}

static void arms_raised_between_forward_and_sideways(void)
{
    stand();
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, 1, 0, 1);
    check_shoulders(90, 45, 90, 90);
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, 1, -1, 1);
    check_shoulders((float)(atan2(sqrt(2), 1) / degree), 45, 45, 45);
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, 1, -1, -1); /* across the chest */
    check_shoulders((float)(atan2(sqrt(2), 1) / degree), 135, 45, -45);
}

static void arms_stretched_back(void)
{
    stand();
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, -1, -1, 0);
    check_shoulders(45, -90, -45, 0);
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, -1, -1, 1);
    check_shoulders((float)(atan2(sqrt(2), 1) / degree), -45, -45, 45);
}

/* Beyond the vertical the angle goes on. */
static void arms_overhead(void)
{
    const double by = tan(5 * degree);
    stand();
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, 0, 1, 0);
    check_shoulders(180, NONE, 180, 180);
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, by, 1, 0);
    check_shoulders(175, NONE, 175, 180);
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, -by, 1, 0);
    check_shoulders(175, NONE, 185, 180);
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, 0, 1, -by);
    check_shoulders(175, NONE, 180, 185);
}

/* 14.5 degrees: a quarter of the bone. */
static void planes_are_told_from_a_quarter_of_the_bone_on(void)
{
    stand();
    for (double elevation = 14; elevation < 16; elevation += 1) {
        const double forward = sin(elevation * degree), down = -cos(elevation * degree);
        point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, forward, down, 0);
        check_shoulders((float)elevation, elevation < 14.5 ? NONE : 90, (float)elevation, 0);
        point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, forward, 0, -down);
        check_shoulders(90, (float)elevation, elevation < 14.5 ? NONE : 90, 90);
    }
}

static void who_sits_has_bent_hips_and_knees(void)
{
    stand();
    point_limbs(EDML_R_HIP, EDML_L_HIP, 1, 0, 0);
    pose.joint[EDML_R_ANKLE] = pose.joint[EDML_R_KNEE];
    pose.joint[EDML_L_ANKLE] = pose.joint[EDML_L_KNEE];
    pose.joint[EDML_R_ANKLE].y += 0.4F;
    pose.joint[EDML_L_ANKLE].y += 0.4F;
    check_hips(90, 0);
    check_pair(EDML_R_KNEE_FLEXION, 90);
    check_angle(EDML_TRUNK_LEAN, 0);
    point_limbs(EDML_R_HIP, EDML_L_HIP, cos(30 * degree), 0, sin(30 * degree)); /* knees apart */
    check_hips(90, 30);
    point_limbs(EDML_R_HIP, EDML_L_HIP, 1, 0.5, 0); /* knees above hips */
    check_hips((float)(90 + atan2(0.5, 1) / degree), 0);
}

static void legs_apart_crossed_and_back(void)
{
    stand();
    point_limbs(EDML_R_HIP, EDML_L_HIP, 0, -cos(20 * degree), sin(20 * degree));
    check_hips(0, 20);
    point_limbs(EDML_R_HIP, EDML_L_HIP, 0, -cos(20 * degree), -sin(20 * degree));
    check_hips(0, -20);
    point_limbs(EDML_R_HIP, EDML_L_HIP, -sin(25 * degree), -cos(25 * degree), 0);
    check_hips(-25, 0);
    point_limbs(EDML_R_HIP, EDML_L_HIP, 0, 0, 1); /* in the splits no flexion is told */
    check_hips(NONE, 90);
}

/* Right limbs have the angles of the right, left ones those of the left. */
static void sides_have_their_own_angles(void)
{
    stand();
    point_limb(EDML_R_SHOULDER, 1, 0, 0);
    point_limb(EDML_L_SHOULDER, 0, 0, 1);
    point_limb(EDML_R_HIP, 1, 0, 0);
    point_limb(EDML_L_HIP, 0, -1, 1);
    pose.joint[EDML_L_WRIST] = point_of(0.45, -0.75, 0);
    pose.joint[EDML_R_ANKLE] = pose.joint[EDML_R_HIP];
    measure(NULL);
    check_angle(EDML_R_SHOULDER_FLEXION, 90);
    check_angle(EDML_L_SHOULDER_ABDUCTION, 90);
    check_angle(EDML_R_HIP_FLEXION, 90);
    check_angle(EDML_R_HIP_ABDUCTION, 0);
    check_angle(EDML_L_HIP_ABDUCTION, 45);
    check_angle(EDML_R_ELBOW_FLEXION, 0);
    check_angle(EDML_L_ELBOW_FLEXION, 90);
    check_angle(EDML_R_KNEE_FLEXION, 180);
    check_angle(EDML_L_KNEE_FLEXION, 0);
}

static void trunks_lean_forward_back_and_sideways(void)
{
    for (int degrees = -70; degrees <= 70; degrees += 35) {
        stand();
        turn('x', degrees); /* the head comes to the camera */
        check_trunk((float)abs(degrees), (float)degrees, 0, 0);
        stand();
        turn('z', -degrees); /* the head goes to the image's left, which is the subject's right */
        check_trunk((float)abs(degrees), 0, (float)degrees, 0);
    }
    stand();
    turn('x', 50); /* both: the lean to the right is out of the plane in which the trunk leans forward */
    turn('z', -20);
    turn('y', -130);
    const double up = cos(50 * degree) * cos(20 * degree);
    check_trunk((float)(acos(up) / degree), (float)(atan2(sin(50 * degree), up) / degree),
                (float)(asin(cos(50 * degree) * sin(20 * degree)) / degree), 130);
}

static void who_lies_has_a_lean_of_90(void)
{
    stand();
    turn('x', -90); /* on the back, feet to the camera */
    check_trunk(90, -90, 0, 0);
    turn('y', 90);
    check_trunk(90, -90, 0, -90);
    stand();
    turn('x', 90); /* on the belly */
    check_trunk(90, 90, 0, 0);
    check_hips(0, 0);
    stand();
    turn('z', 90); /* on the left side: shoulders and hips are above each other */
    check_trunk(90, NONE, NONE, NONE);
    check_hips(0, 0);
}

static void who_is_upside_down_has_a_lean_of_180(void)
{
    stand();
    point_limbs(EDML_R_SHOULDER, EDML_L_SHOULDER, 0, 1, 0); /* a handstand that faces the camera */
    turn('z', 180);
    check_trunk(180, 180, 0, 180);
    check_shoulders(180, NONE, 180, 180);
    check_hips(0, 0);
    const edml_point down = {0, 1, 0}; /* or the camera is upside down */
    measure(&down);
    check_angle(EDML_TRUNK_LEAN, 0);
    check_angle(EDML_HEADING, 0);
}

static void headings_go_round(void)
{
    for (int degrees = -165; degrees <= 180; degrees += 15) {
        stand();
        turn('y', -degrees); /* the image's right is 90 */
        measure(NULL);
        check_angle(EDML_HEADING, (float)degrees);
    }
}

/* ---- The camera, size, sides ------------------------------------------------------------------------------ */

/* As wide as people are: an axis of a shorter line is less sure in fixed point. */
static void someone(rng *r)
{
    stand();
    do random_human(r, pose.joint);
    while (distance_between(pose.joint[EDML_R_HIP], pose.joint[EDML_L_HIP]) < 0.1);
    rotate_points(pose.joint, random_rotation(r), pose.joint);
    root_at_mid_hip(pose.joint);
}

/* By how much two angles differ, a whole turn being nothing; 0 if neither is there. */
static float difference(float a, float b)
{
    if (isnan(a) && isnan(b)) return 0;
    const float apart = fabsf(a - b);
    return apart > 180 ? 360 - apart : apart;
}

/* Angles that are there in one and not in the other count as lost: where a bone has a quarter in the plane. */
static void check_same(const float expected[EDML_ANGLES], int *lost)
{
    for (int n = 0; n < EDML_ANGLES; n++) {
        if (isnan(expected[n]) != isnan(found[n]))
            ++*lost;
        else
            TEST_ASSERT_FLOAT_WITHIN_MESSAGE(ANYONE_S_ANGLE_TOLERANCE, 0, difference(expected[n], found[n]),
                                             edml_angle_name(n));
    }
}

static void rolling_the_camera_changes_nothing_with_up_given(void)
{
    rng r = rng_seed(160);
    int lost = 0;
    for (int n = 0; n < 500; n++) {
        float before[EDML_ANGLES];
        someone(&r);
        const edml_point up = point_of((double)gauss(&r) / 4, -1, (double)gauss(&r) / 4);
        measure(&up);
        memcpy(before, found, sizeof before);
        const rotation3 roll = rotation_about('z', (double)uniform(&r, -180, 180));
        const edml_point rolled = turned(up, roll);
        rotate_points(pose.joint, roll, pose.joint);
        measure(&rolled);
        check_same(before, &lost);
    }
    TEST_ASSERT_TRUE(lost <= ANGLES_LOST);
}

/* All but the heading, which is told from where the camera is. */
static void turning_the_camera_any_way_changes_no_other_angle(void)
{
    rng r = rng_seed(161);
    int lost = 0;
    for (int n = 0; n < 500; n++) {
        float before[EDML_ANGLES];
        someone(&r);
        measure(&level);
        memcpy(before, found, sizeof before);
        const rotation3 by = random_rotation(&r);
        const edml_point up = turned(level, by);
        rotate_points(pose.joint, by, pose.joint);
        measure(&up);
        before[EDML_HEADING] = found[EDML_HEADING];
        check_same(before, &lost);
    }
    TEST_ASSERT_TRUE(lost <= ANGLES_LOST);
}

static void up_is_a_level_camera_s_by_default_and_of_any_length(void)
{
    rng r = rng_seed(162);
    int lost = 0;
    for (int n = 0; n < 100; n++) {
        float before[EDML_ANGLES];
        const edml_point far_up = {0, -700, 0}, near_up = {0, -0.01F, 0};
        someone(&r);
        measure(NULL);
        memcpy(before, found, sizeof before);
        measure(&far_up);
        TEST_ASSERT_EQUAL_MEMORY(before, found, sizeof before);
        measure(&near_up);
        check_same(before, &lost);
    }
    TEST_ASSERT_TRUE(lost == 0);
}

static void a_mirror_exchanges_right_and_left(void)
{
    rng r = rng_seed(163);
    for (int n = 0; n < 500; n++) {
        float before[EDML_ANGLES];
        int lost = 0;
        someone(&r);
        const edml_pose given = pose;
        measure(NULL);
        for (int k = 0; k < EDML_TRUNK_LEAN; k++) before[k] = found[k ^ 1];
        before[EDML_TRUNK_LEAN] = found[EDML_TRUNK_LEAN];
        before[EDML_TRUNK_LEAN_FORWARD] = found[EDML_TRUNK_LEAN_FORWARD];
        before[EDML_TRUNK_LEAN_RIGHT] = -found[EDML_TRUNK_LEAN_RIGHT];
        before[EDML_HEADING] = -found[EDML_HEADING];
        for (int j = 0; j < EDML_JOINTS; j++) {
            pose.joint[j] = given.joint[edml_mirror_joint[j]];
            pose.joint[j].x *= -1;
        }
        measure(NULL);
        check_same(before, &lost);
        TEST_ASSERT_TRUE(lost == 0);
    }
}

static void size_and_place_do_not_matter(void)
{
    rng r = rng_seed(164);
    int lost = 0;
    for (int n = 0; n < 200; n++) {
        float before[EDML_ANGLES];
        someone(&r);
        measure(NULL);
        memcpy(before, found, sizeof before);
        for (int j = 0; j < EDML_JOINTS; j++)
            pose.joint[j] = point_of((double)(1.5F * pose.joint[j].x) + 0.5,
                                     (double)(1.5F * pose.joint[j].y) - 1,
                                     (double)(1.5F * pose.joint[j].z) + 1.25);
        measure(NULL);
        check_same(before, &lost);
    }
    TEST_ASSERT_TRUE(lost <= ANGLES_LOST);
}

/* ---- What is not there ------------------------------------------------------------------------------------- */

#define BIT(joint) (1U << (joint))

/* The joints that each angle needs, right ones; a left angle needs their mirror images. */
static unsigned needed_by(int angle)
{
    static const unsigned trunk = BIT(EDML_NECK_BASE) | BIT(EDML_R_HIP) | BIT(EDML_L_HIP);
    static const unsigned shoulders = BIT(EDML_R_SHOULDER) | BIT(EDML_L_SHOULDER);
    unsigned joints = 0, mirrored = 0;
    switch (angle < EDML_TRUNK_LEAN ? angle / 2 * 2 : angle) {
    case EDML_R_ELBOW_FLEXION:
        joints = BIT(EDML_R_SHOULDER) | BIT(EDML_R_ELBOW) | BIT(EDML_R_WRIST);
        break;
    case EDML_R_KNEE_FLEXION:
        joints = BIT(EDML_R_HIP) | BIT(EDML_R_KNEE) | BIT(EDML_R_ANKLE);
        break;
    case EDML_R_HIP_FLEXION:
    case EDML_R_HIP_ABDUCTION:
        joints = trunk | BIT(EDML_R_KNEE);
        break;
    case EDML_TRUNK_LEAN:
        joints = trunk;
        break;
    case EDML_TRUNK_LEAN_FORWARD:
    case EDML_TRUNK_LEAN_RIGHT:
        joints = trunk | shoulders;
        break;
    case EDML_HEADING:
        joints = (trunk | shoulders) & ~BIT(EDML_NECK_BASE);
        break;
    default:
        joints = trunk | shoulders | BIT(EDML_R_ELBOW);
    }
    for (int j = 0; j < EDML_JOINTS; j++)
        if (joints & BIT(j)) mirrored |= BIT(edml_mirror_joint[j]);
    return angle < EDML_TRUNK_LEAN && angle % 2 == LEFT ? mirrored : joints;
}

static void an_angle_needs_its_joints_and_no_others(void)
{
    rng r = rng_seed(165);
    for (int n = 0; n < 2000; n++) {
        float whole[EDML_ANGLES];
        someone(&r);
        measure(NULL);
        memcpy(whole, found, sizeof whole);
        pose.seen = (uint16_t)(n < EDML_JOINTS ? ALL_SEEN & ~BIT(n) : rng_bits(&r) & ALL_SEEN);
        measure(NULL);
        for (int k = 0; k < EDML_ANGLES; k++) {
            if ((pose.seen & needed_by(k)) != needed_by(k))
                TEST_ASSERT_FLOAT_IS_NAN_MESSAGE(found[k], edml_angle_name(k));
            else
                TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&whole[k], &found[k], sizeof whole[k], edml_angle_name(k));
        }
    }
}

static void a_point_has_no_angle(void)
{
    stand();
    equal_points(pose.joint, 0, 0, 0);
    measure(NULL);
    for (int n = 0; n < EDML_ANGLES; n++) check_angle(n, NONE);
}

static void a_bone_without_length_has_no_angle(void)
{
    stand();
    pose.joint[EDML_R_KNEE] = pose.joint[EDML_R_HIP];
    pose.joint[EDML_L_ELBOW] = pose.joint[EDML_L_SHOULDER];
    measure(NULL);
    check_angle(EDML_R_KNEE_FLEXION, NONE);
    check_angle(EDML_R_HIP_FLEXION, NONE);
    check_angle(EDML_R_HIP_ABDUCTION, NONE);
    check_angle(EDML_L_HIP_FLEXION, 0);
    check_angle(EDML_L_ELBOW_FLEXION, NONE);
    for (int n = EDML_L_SHOULDER_ELEVATION; n <= EDML_L_SHOULDER_ABDUCTION; n += 2) check_angle(n, NONE);
    check_angle(EDML_R_SHOULDER_FLEXION, 0);
    check_angle(EDML_TRUNK_LEAN, 0);
    stand();
    pose.joint[EDML_R_ANKLE] = pose.joint[EDML_R_KNEE];
    pose.joint[EDML_L_WRIST] = pose.joint[EDML_L_ELBOW];
    measure(NULL);
    check_angle(EDML_R_KNEE_FLEXION, NONE);
    check_angle(EDML_R_HIP_FLEXION, 0);
    check_angle(EDML_L_ELBOW_FLEXION, NONE);
    check_angle(EDML_L_SHOULDER_FLEXION, 0);
}

/* The hips at the neck, or above each other. */
static void a_trunk_without_axes_leaves_limbs_alone(void)
{
    stand();
    pose.joint[EDML_NECK_BASE] = point_of(0, 0, 0);
    measure(NULL);
    check_pair(EDML_R_KNEE_FLEXION, 0);
    for (int n = EDML_R_HIP_FLEXION; n < EDML_HEADING; n++) check_angle(n, NONE);
    check_angle(EDML_HEADING, 0);
    stand();
    pose.joint[EDML_R_HIP] = point_of(0, -0.1, 0);
    pose.joint[EDML_L_HIP] = point_of(0, 0.1, 0);
    measure(NULL);
    for (int n = EDML_R_HIP_FLEXION; n <= EDML_L_HIP_ABDUCTION; n++) check_angle(n, NONE);
    check_pair(EDML_R_SHOULDER_ABDUCTION, 0);
}

static void a_camera_that_looks_straight_down_sees_no_heading(void)
{
    const edml_point up = {0, 0, -1};
    stand();
    turn('x', 90);
    measure(&up);
    check_angle(EDML_HEADING, NONE);
    check_angle(EDML_TRUNK_LEAN, 0);
    check_angle(EDML_TRUNK_LEAN_FORWARD, 0);
}

static void check_refused(edml_status status, edml_point up)
{
    float untouched[EDML_ANGLES];
    memset(found, 0x5A, sizeof found);
    memcpy(untouched, found, sizeof found);
    TEST_ASSERT_EQUAL_INT(status, edml_angles(found, &pose, &up));
    TEST_ASSERT_SAME_BYTES(untouched, found);
}

static void no_pose_and_no_upwards_are_refused(void)
{
    static const float wrong[] = {NAN, INFINITY, -INFINITY};
    stand();
    check_refused(EDML_ERR_DEGENERATE, point_of(0, 0, 0));
    for (int n = 0; n < 3; n++) {
        const edml_point x = {wrong[n], -1, 0}, z = {0, -1, wrong[n]};
        check_refused(EDML_ERR_NOT_FINITE, x);
        check_refused(EDML_ERR_NOT_FINITE, z);
        stand();
        pose.joint[EDML_L_WRIST].y = wrong[n];
        check_refused(EDML_ERR_NOT_FINITE, level);
        stand();
    }
    pose.joint[EDML_HEAD].x = 4.1F;
    check_refused(EDML_ERR_NOT_FINITE, level);
}

/* ---- Names, fixed point ------------------------------------------------------------------------------------- */

static void names_come_in_pairs(void)
{
    TEST_ASSERT_EQUAL_STRING("right_elbow_flexion", edml_angle_name(EDML_R_ELBOW_FLEXION));
    TEST_ASSERT_EQUAL_STRING("left_shoulder_abduction", edml_angle_name(EDML_L_SHOULDER_ABDUCTION));
    TEST_ASSERT_EQUAL_STRING("trunk_lean_right", edml_angle_name(EDML_TRUNK_LEAN_RIGHT));
    TEST_ASSERT_EQUAL_STRING("heading", edml_angle_name(EDML_HEADING));
    TEST_ASSERT_EQUAL_STRING("?", edml_angle_name(-1));
    TEST_ASSERT_EQUAL_STRING("?", edml_angle_name(EDML_ANGLES));
    for (int n = 0; n < EDML_TRUNK_LEAN; n += 2) {
        TEST_ASSERT_EQUAL_INT(0, strncmp(edml_angle_name(n), "right_", 6));
        TEST_ASSERT_EQUAL_INT(0, strncmp(edml_angle_name(n + 1), "left_", 5));
        TEST_ASSERT_EQUAL_STRING(edml_angle_name(n) + 6, edml_angle_name(n + 1) + 5);
    }
}

#ifndef EDML_TEST_Q24
static void fixed_point_measures_the_same(void)
{
    rng r = rng_seed(166);
    int lost = 0;
    float worst = 0;
    for (int n = 0; n < 4000; n++) {
        float fixed[EDML_ANGLES];
        someone(&r);
        const edml_point up = point_of((double)gauss(&r), (double)gauss(&r), (double)gauss(&r));
        pose.seen = n % 3 ? ALL_SEEN : (uint16_t)rng_bits(&r);
        measure(n % 2 ? &up : NULL);
        TEST_ASSERT_EQUAL_INT(EDML_OK, q24_angles(fixed, &pose, n % 2 ? &up : NULL));
        for (int k = 0; k < EDML_ANGLES; k++) {
            lost += isnan(found[k]) != isnan(fixed[k]);
            const float apart = difference(found[k], fixed[k]);
            if (apart > worst) worst = apart;
        }
    }
    printf("angles: fixed point is at most %.4f degrees off, %d are there in one alone\n", (double)worst,
           lost);
    TEST_ASSERT_TRUE(worst < FIXED_ANGLE_TOLERANCE);
    TEST_ASSERT_TRUE(lost <= FIXED_ANGLES_LOST);
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(who_stands_has_zero_everywhere);
    RUN_TEST(arms_held_out_as_a_t);
    RUN_TEST(arms_raised_forward);
    RUN_TEST(arms_raised_between_forward_and_sideways);
    RUN_TEST(arms_stretched_back);
    RUN_TEST(arms_overhead);
    RUN_TEST(planes_are_told_from_a_quarter_of_the_bone_on);
    RUN_TEST(who_sits_has_bent_hips_and_knees);
    RUN_TEST(legs_apart_crossed_and_back);
    RUN_TEST(sides_have_their_own_angles);
    RUN_TEST(trunks_lean_forward_back_and_sideways);
    RUN_TEST(who_lies_has_a_lean_of_90);
    RUN_TEST(who_is_upside_down_has_a_lean_of_180);
    RUN_TEST(headings_go_round);
    RUN_TEST(rolling_the_camera_changes_nothing_with_up_given);
    RUN_TEST(turning_the_camera_any_way_changes_no_other_angle);
    RUN_TEST(up_is_a_level_camera_s_by_default_and_of_any_length);
    RUN_TEST(a_mirror_exchanges_right_and_left);
    RUN_TEST(size_and_place_do_not_matter);
    RUN_TEST(an_angle_needs_its_joints_and_no_others);
    RUN_TEST(a_point_has_no_angle);
    RUN_TEST(a_bone_without_length_has_no_angle);
    RUN_TEST(a_trunk_without_axes_leaves_limbs_alone);
    RUN_TEST(a_camera_that_looks_straight_down_sees_no_heading);
    RUN_TEST(no_pose_and_no_upwards_are_refused);
    RUN_TEST(names_come_in_pairs);
#ifndef EDML_TEST_Q24
    RUN_TEST(fixed_point_measures_the_same);
#endif
    return UNITY_END();
}
