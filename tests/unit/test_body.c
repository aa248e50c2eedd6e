/* optional/body.h, quality.h, stand.h and uncertainty.c: what can be done with a lifted pose.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "as_float.h"

#define CHAIN 0.902F /* from head to ankle, relative to the standing height: docs/body.md */
#define ANKLE 0.07F  /* metres above the floor */

static edml_pose pose, before;
static edml_body body;

/* ---- Poses ------------------------------------------------------------------------------------- */

static void lift_of(const edml_point x[EDML_JOINTS])
{
    memset(&pose, 0, sizeof pose);
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose.joint[j].x = x[j].x - (x[EDML_R_HIP].x + x[EDML_L_HIP].x) / 2;
        pose.joint[j].y = x[j].y - (x[EDML_R_HIP].y + x[EDML_L_HIP].y) / 2;
        pose.joint[j].z = x[j].z - (x[EDML_R_HIP].z + x[EDML_L_HIP].z) / 2;
    }
    pose.misfit = 0.01F;
    pose.seen = ALL_SEEN;
    before = pose;
}

static void someone(rng *r)
{
    edml_point x[EDML_JOINTS];
    random_human(r, x);
    rotate_points(x, random_rotation(r), x);
    lift_of(x);
    memset(&body, 0, sizeof body);
}

static double length_of(const edml_pose *of, int bone)
{
    return distance_between(of->joint[edml_bones[bone].from], of->joint[edml_bones[bone].to]);
}

static double chain_of(const edml_pose *of)
{
    double sum = 2 * length_of(of, 0);
    for (int n = 7; n < EDML_BONES; n++) sum += length_of(of, n);
    return sum / 2;
}

/* Cosine between a bone of the pose and what it was before. */
static double kept_direction(int bone)
{
    const edml_point a = pose.joint[edml_bones[bone].from], b = pose.joint[edml_bones[bone].to];
    const edml_point c = before.joint[edml_bones[bone].from], d = before.joint[edml_bones[bone].to];
    const double product = (double)(b.x - a.x) * (double)(d.x - c.x) +
                           (double)(b.y - a.y) * (double)(d.y - c.y) +
                           (double)(b.z - a.z) * (double)(d.z - c.z);
    return product / length_of(&pose, bone) / length_of(&before, bone);
}

static void check_fit(void)
{
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_fit_body(&pose, &body));
    TEST_ASSERT_ERROR_UP_TO(BODY_TOLERANCE, pose.joint[EDML_R_HIP].x + pose.joint[EDML_L_HIP].x);
    TEST_ASSERT_ERROR_UP_TO(BODY_TOLERANCE, pose.joint[EDML_R_HIP].y + pose.joint[EDML_L_HIP].y);
    TEST_ASSERT_ERROR_UP_TO(BODY_TOLERANCE, pose.joint[EDML_R_HIP].z + pose.joint[EDML_L_HIP].z);
    for (int n = 0; n < EDML_BONES; n++) TEST_ASSERT_TRUE(kept_direction(n) > BODY_COSINE);
}

static void check_refused(edml_status status)
{
    const edml_pose given = pose;
    TEST_ASSERT_EQUAL_INT(status, edml_fit_body(&pose, &body));
    TEST_ASSERT_SAME_BYTES(given, pose);
}

/* ---- The person's size --------------------------------------------------------------------------- */

static void nothing_known_leaves_the_pose(void)
{
    rng r = rng_seed(130);
    for (int n = 0; n < 50; n++) {
        someone(&r);
        check_fit();
        TEST_ASSERT_ERROR_UP_TO(BODY_TOLERANCE, worst_joint_error(pose.joint, before.joint));
        TEST_ASSERT_TRUE(pose.misfit == before.misfit && pose.seen == before.seen);
    }
}

static void a_height_scales_all_alike(void)
{
    rng r = rng_seed(131);
    for (int n = 0; n < 100; n++) {
        someone(&r);
        body.height = uniform(&r, 0.5F, 2.5F);
        const float scale = CHAIN * body.height / (float)chain_of(&before);
        check_fit();
        for (int j = 0; j < EDML_JOINTS; j++) {
            TEST_ASSERT_FLOAT_WITHIN(BODY_TOLERANCE, scale * before.joint[j].x, pose.joint[j].x);
            TEST_ASSERT_FLOAT_WITHIN(BODY_TOLERANCE, scale * before.joint[j].y, pose.joint[j].y);
            TEST_ASSERT_FLOAT_WITHIN(BODY_TOLERANCE, scale * before.joint[j].z, pose.joint[j].z);
        }
    }
}

static void known_bones_get_their_length_and_others_keep_theirs(void)
{
    rng r = rng_seed(132);
    for (int n = 0; n < 100; n++) {
        someone(&r);
        const int known = n % EDML_BONES;
        body.bone[known] = (float)length_of(&before, known) * uniform(&r, 0.9F, 1.1F);
        body.bone[9] = (float)length_of(&before, 9) * uniform(&r, 0.9F, 1.1F);
        check_fit();
        for (int k = 0; k < EDML_BONES; k++) {
            const double wanted = body.bone[k] > 0 ? (double)body.bone[k] : length_of(&before, k);
            TEST_ASSERT_FLOAT_WITHIN(BODY_TOLERANCE, (float)wanted, (float)length_of(&pose, k));
        }
    }
}

static void with_a_height_too_the_other_bones_are_scaled(void)
{
    rng r = rng_seed(133);
    for (int n = 0; n < 100; n++) {
        someone(&r);
        body.height = uniform(&r, 1.5F, 1.9F);
        body.bone[8] = body.bone[11] = 0.4F;
        const double scale = (double)(CHAIN * body.height) / chain_of(&before);
        check_fit();
        for (int k = 0; k < EDML_BONES; k++) {
            const double wanted = k == 8 || k == 11 ? 0.4 : scale * length_of(&before, k);
            TEST_ASSERT_FLOAT_WITHIN(BODY_TOLERANCE, (float)wanted, (float)length_of(&pose, k));
        }
    }
}

static void absurd_measures_are_refused(void)
{
    static const float heights[] = {-1.7F, 0.3F, 2.6F, 10, 170, 1e30F, -1e30F, INFINITY, NAN};
    static const float bones[] = {-0.4F, 0.01F, 1.2F, 5, 40, INFINITY, NAN};
    rng r = rng_seed(134);
    for (unsigned n = 0; n < sizeof heights / sizeof *heights; n++) {
        someone(&r);
        body.height = heights[n];
        check_refused(EDML_ERR_BODY);
    }
    for (unsigned n = 0; n < sizeof bones / sizeof *bones; n++) {
        someone(&r);
        body.bone[8] = bones[n];
        check_refused(EDML_ERR_BODY);
        body.height = 1.75F;
        check_refused(EDML_ERR_BODY);
    }
}

static void measures_of_two_people_are_refused(void)
{
    rng r = rng_seed(135);
    someone(&r);
    body.bone[8] = 0.25F; /* a child's thigh, a man's shin */
    body.bone[9] = 0.45F;
    check_refused(EDML_ERR_BODY);
    body.bone[9] = 0.28F;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_fit_body(&pose, &body));
    body.height = 1.8F;
    check_refused(EDML_ERR_BODY);
}

static void a_bone_of_nobody_is_refused(void)
{
    rng r = rng_seed(135);
    for (int n = 0; n < EDML_BONES; n++) {
        someone(&r);
        body.bone[n] = 2;
        check_refused(EDML_ERR_BODY);
    }
}

static void a_pose_that_is_none_is_refused(void)
{
    rng r = rng_seed(136);
    someone(&r);
    body.height = 1.75F;
    pose.joint[EDML_L_KNEE].y = NAN;
    before = pose;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, edml_fit_body(&pose, &body));
    someone(&r);
    body.height = 1.75F;
    pose.joint[EDML_L_KNEE].y = -4.1F;
    check_refused(EDML_ERR_NOT_FINITE);
    someone(&r);
    equal_points(pose.joint, 0, 0, 0);
    body.height = 1.75F;
    check_refused(EDML_ERR_DEGENERATE);
    body.height = 0;
    body.bone[3] = 0.25F;
    check_refused(EDML_ERR_DEGENERATE);
}

static void a_pose_of_quite_another_size_is_refused(void)
{
    rng r = rng_seed(137);
    someone(&r);
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose.joint[j].x *= 0.4F;
        pose.joint[j].y *= 0.4F;
        pose.joint[j].z *= 0.4F;
    }
    body.height = 1.75F;
    check_refused(EDML_ERR_DEGENERATE);
}

/* ---- Quality ------------------------------------------------------------------------------------- */

/* An average body, which human_pose() is not. */
static void average_human(void)
{
    static const edml_point standing[EDML_JOINTS] = {
        {0, -0.77F, -0.05F},      {0, -0.48F, 0},          {-0.18F, -0.54F, 0},    {-0.20F, -0.26F, 0.04F},
        {-0.22F, -0.05F, -0.12F}, {0.18F, -0.54F, 0},      {0.20F, -0.26F, 0.04F}, {0.22F, -0.05F, -0.12F},
        {-0.10F, 0, 0},           {-0.12F, 0.39F, -0.08F}, {-0.12F, 0.80F, 0},     {0.10F, 0, 0},
        {0.12F, 0.39F, -0.08F},   {0.12F, 0.80F, 0},
    };
    lift_of(standing);
}

static float quality_of(void)
{
    float quality = -1;
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_quality(&quality, &pose));
    return quality;
}

static float quality_without(int joint)
{
    average_human();
    pose.seen = (uint16_t)(pose.seen & ~(1 << joint));
    return quality_of();
}

static void a_sound_pose_has_a_high_quality(void)
{
    average_human();
    const float quality = quality_of();
    printf("quality of a sound pose: %.3f\n", (double)quality);
    TEST_ASSERT_TRUE(quality > 0.9F && quality < 1);
}

static void whatever_is_wrong_lowers_quality(void)
{
    average_human();
    const float sound = quality_of();
    pose.misfit = 0.05F;
    TEST_ASSERT_TRUE(quality_of() < sound);
    average_human();
    pose.joint[EDML_L_WRIST].z += 0.6F; /* a forearm of half a metre */
    TEST_ASSERT_TRUE(quality_of() < sound);
    TEST_ASSERT_TRUE(quality_without(EDML_L_WRIST) < sound);
}

static void the_larger_the_misfit_the_lower_the_quality(void)
{
    static const float misfit[] = {0, 0.01F, 0.02F, 0.05F, 0.1F, 0.2F, 0.4F};
    float last = 1;
    for (int n = 0; n < 7; n++) {
        average_human();
        pose.misfit = misfit[n];
        const float quality = quality_of();
        TEST_ASSERT_TRUE(quality < last && quality > 0);
        last = quality;
    }
    TEST_ASSERT_TRUE(last < 0.05F);
    pose.misfit = 0.5F; /* from here on it is the same */
    last = quality_of();
    pose.misfit = 3e4F;
    TEST_ASSERT_TRUE(quality_of() == last);
}

/* Turned about the vertical. */
static void the_more_from_the_side_the_higher_the_quality(void)
{
    float last = 0;
    for (int degrees = 0; degrees <= 90; degrees += 15) {
        const double angle = degrees * 3.14159265358979 / 180;
        const rotation3 by = {{{cos(angle), 0, sin(angle)}, {0, 1, 0}, {-sin(angle), 0, cos(angle)}}};
        average_human();
        rotate_points(pose.joint, by, pose.joint);
        const float quality = quality_of();
        TEST_ASSERT_TRUE(quality > last && quality < 1);
        last = quality;
    }
}

/* As an image of something else is lifted. */
static void joints_anywhere_have_hardly_any_quality(void)
{
    rng r = rng_seed(138);
    for (int n = 0; n < 200; n++) {
        average_human();
        random_points(&r, pose.joint, 3);
        const float quality = quality_of();
        TEST_ASSERT_TRUE(quality >= 0 && quality < 0.01F);
    }
}

static void each_missing_joint_lowers_quality_alike(void)
{
    const float quality = quality_without(EDML_HEAD);
    for (int j = 1; j < EDML_JOINTS; j++) TEST_ASSERT_TRUE(quality == quality_without(j));
    pose.seen = (uint16_t)(pose.seen | 0xC000); /* bits of no joints */
    TEST_ASSERT_TRUE(quality == quality_of());
    pose.seen = ALL_SEEN >> 4;
    TEST_ASSERT_TRUE(quality_of() < quality && quality_of() > 0);
}

/* A body of the lengths given, metres, seen from the front unless `turned`; no bone points up or down alone. */
static void body_of(const float length[EDML_BONES], const rotation3 *turned)
{
    static const edml_point along[EDML_BONES] = {
        {0, -1, 0},        {-1, 0, 0},      {-0.6F, 0.8F, 0},   {0, 1, 0},        {1, 0, 0},
        {0.6F, 0.8F, 0},   {0, 1, 0},       {-0.28F, 0.96F, 0}, {-0.6F, 0.8F, 0}, {0, 1, 0},
        {0.28F, 0.96F, 0}, {0.6F, 0.8F, 0}, {0, 1, 0},
    };
    edml_point x[EDML_JOINTS] = {{0, 0, 0}};
    for (int n = 0; n < EDML_BONES; n++) {
        const edml_point from = x[edml_bones[n].from];
        const edml_point to = {from.x + length[n] * along[n].x, from.y + length[n] * along[n].y, 0};
        x[edml_bones[n].to] = to;
    }
    if (turned != NULL) rotate_points(x, *turned, x);
    lift_of(x);
}

static const float usual_bones[EDML_BONES] = {0.29F,  0.195F, 0.26F, 0.26F,  0.195F, 0.26F, 0.26F,
                                              0.455F, 0.405F, 0.42F, 0.455F, 0.405F, 0.42F};

/* A pose of so many times the body's length from head to ankle. */
static edml_status fit_pose_of(float times)
{
    memset(&body, 0, sizeof body);
    body.height = 0.51F;
    body_of(usual_bones, NULL);
    const float factor = times * CHAIN * body.height / (float)chain_of(&pose);
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose.joint[j].x *= factor;
        pose.joint[j].y *= factor;
        pose.joint[j].z *= factor;
    }
    return edml_fit_body(&pose, &body);
}

static void poses_from_half_to_eight_times_the_body_are_fitted(void)
{
    static const float fits[] = {0.51F, 1, 7.5F, 7.95F}, none[] = {0.49F, 8.05F, 8.5F};
    for (int n = 0; n < 4; n++) TEST_ASSERT_EQUAL_INT(EDML_OK, fit_pose_of(fits[n]));
    for (int n = 0; n < 3; n++) TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, fit_pose_of(none[n]));
}

static void heights_from_half_a_metre_are_a_body_s(void)
{
    static const float height[] = {0.35F, 0.4F, 0.49F, 0.51F};
    for (int n = 0; n < 4; n++) {
        body_of(usual_bones, NULL);
        memset(&body, 0, sizeof body);
        body.height = height[n];
        TEST_ASSERT_EQUAL_INT(n < 3 ? EDML_ERR_BODY : EDML_OK, edml_fit_body(&pose, &body));
    }
}

/* A bone that is to become more than 64 times as long has no direction. */
static void bones_become_up_to_64_times_as_long(void)
{
    static const float times[] = {63, 64.6F};
    for (int n = 0; n < 2; n++) {
        float bones[EDML_BONES];
        memcpy(bones, usual_bones, sizeof bones);
        bones[3] = 0.25F / times[n];
        body_of(bones, NULL);
        memset(&body, 0, sizeof body);
        body.bone[3] = 0.25F;
        TEST_ASSERT_EQUAL_INT(n ? EDML_ERR_DEGENERATE : EDML_OK, edml_fit_body(&pose, &body));
    }
}

/* What the quality is the sigmoid of, (1 + s / sqrt(1 + s^2)) / 2. */
static double score_of(void)
{
    const double q = 2 * (double)quality_of() - 1;
    return q / sqrt(1 - q * q);
}

static void quality_costs_what_the_fit_says(void)
{
    body_of(usual_bones, NULL);
    pose.misfit = 0;
    TEST_ASSERT_FLOAT_WITHIN(SCORE_TOLERANCE, 2.814F, (float)score_of());
    pose.misfit = 0.1F;
    TEST_ASSERT_FLOAT_WITHIN(SCORE_TOLERANCE, 2.814F - 2.0031F, (float)score_of());
    pose.seen = ALL_SEEN & ~(1 << EDML_HEAD | 1 << EDML_L_KNEE);
    TEST_ASSERT_FLOAT_WITHIN(SCORE_TOLERANCE, 2.814F - 2.0031F - 2 * 0.422F, (float)score_of());
}

static void misfits_count_up_to_half_a_metre(void)
{
    float quality[4];
    for (int n = 0; n < 4; n++) {
        body_of(usual_bones, NULL);
        pose.misfit = 0.3F + 0.1F * (float)n;
        quality[n] = quality_of();
    }
    TEST_ASSERT_TRUE(quality[0] > quality[1] && quality[1] > quality[2]);
    TEST_ASSERT_TRUE(quality[2] == quality[3]);
}

/* Each bone alike, too short or too long; a centimetre within the range costs nothing. */
static void a_bone_out_of_the_range_costs_by_the_metre(void)
{
    body_of(usual_bones, NULL);
    const float usual = quality_of();
    for (int n = 0; n < EDML_BONES; n++) {
        float bones[EDML_BONES];
        double score[4];
        memcpy(bones, usual_bones, sizeof bones);
        bones[n] = usual_bones[n] + 0.01F;
        body_of(bones, NULL);
        TEST_ASSERT_FLOAT_WITHIN(ROUNDING, usual, quality_of());
        for (int k = 0; k < 4; k++) {
            static const float length[] = {0.04F, 0.06F, 0.6F, 0.65F};
            bones[n] = length[k];
            body_of(bones, NULL);
            score[k] = score_of();
            TEST_ASSERT_TRUE(quality_of() < usual);
        }
        TEST_ASSERT_FLOAT_WITHIN(SCORE_TOLERANCE, 7.154F * 0.02F, (float)(score[1] - score[0]));
        TEST_ASSERT_FLOAT_WITHIN(SCORE_TOLERANCE, 7.154F * 0.05F, (float)(score[2] - score[3]));
    }
}

static void bones_count_up_to_four_metres(void)
{
    static const float each[] = {0.6F, 0.66F, 0.69F, 0.71F};
    float quality[4];
    for (int n = 0; n < 4; n++) { /* 2.9 m too long in all, 3.6, 4.04, 4.3 */
        float bones[EDML_BONES];
        for (int b = 0; b < EDML_BONES; b++) bones[b] = each[n];
        body_of(bones, NULL);
        quality[n] = quality_of();
    }
    TEST_ASSERT_TRUE(quality[0] > quality[1] && quality[1] > quality[2]);
    TEST_ASSERT_TRUE(quality[2] == quality[3]);
}

/* By the share of depth of the line from right to left, through the middles of shoulder and hip. */
static void the_view_from_the_side_gains_its_share_of_depth(void)
{
    rng r = rng_seed(139);
    for (int n = 0; n < 50; n++) {
        const rotation3 by = random_rotation(&r);
        body_of(usual_bones, &by);
        pose.misfit = 0;
        pose.joint[EDML_L_HIP].z += 0.1F; /* the two lines differ */
        pose.joint[EDML_L_KNEE].z += 0.1F;
        pose.joint[EDML_L_ANKLE].z += 0.1F;
        const edml_point *x = pose.joint;
        edml_point line = {x[EDML_L_SHOULDER].x + x[EDML_L_HIP].x - x[EDML_R_SHOULDER].x - x[EDML_R_HIP].x,
                           x[EDML_L_SHOULDER].y + x[EDML_L_HIP].y - x[EDML_R_SHOULDER].y - x[EDML_R_HIP].y,
                           x[EDML_L_SHOULDER].z + x[EDML_L_HIP].z - x[EDML_R_SHOULDER].z - x[EDML_R_HIP].z};
        const double length = distance_between(line, (edml_point){0, 0, 0});
        const double trunk = length_of(&pose, 10), too_long = trunk > 0.52 ? trunk - 0.52 : 0;
        const double too_short = trunk < 0.39 ? 0.39 - trunk : 0;
        const double expected = 2.814 + 0.850 * fabs((double)line.z) / length -
                                7.154 * (too_long + too_short);
        TEST_ASSERT_FLOAT_WITHIN(SCORE_TOLERANCE, (float)expected, (float)score_of());
    }
}

static void check_no_quality(edml_status status)
{
    float quality = 77;
    TEST_ASSERT_EQUAL_INT(status, edml_quality(&quality, &pose));
    TEST_ASSERT_TRUE(quality == 77);
}

static void what_no_lift_returns_has_no_quality(void)
{
    average_human();
    pose.joint[3].z = INFINITY;
    check_no_quality(EDML_ERR_NOT_FINITE);
    average_human();
    pose.joint[3].z = 4.1F;
    check_no_quality(EDML_ERR_NOT_FINITE);
    average_human();
    pose.misfit = -1;
    check_no_quality(EDML_ERR_ARGUMENT);
#ifndef EDML_TEST_Q24 /* integers are never NaN */
    average_human();
    pose.misfit = NAN;
    check_no_quality(EDML_ERR_ARGUMENT);
#endif
    average_human();
    pose.seen = ALL_SEEN >> 5;
    check_no_quality(EDML_ERR_TOO_FEW_JOINTS);
    pose.seen = 0;
    check_no_quality(EDML_ERR_TOO_FEW_JOINTS);
    pose.seen = 0xC000 | ALL_SEEN >> 5;
    check_no_quality(EDML_ERR_TOO_FEW_JOINTS);
}

/* ---- Floor --------------------------------------------------------------------------------------- */

static edml_point stood[EDML_JOINTS];

static edml_point point_of(float x, float y, float z)
{
    const edml_point p = {x, y, z};
    return p;
}

static void check_stand(edml_point up)
{
    float distance[EDML_PAIRS];
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_stand(stood, &pose, up));
    pair_distances(distance, pose.joint);
    TEST_ASSERT_ERROR_UP_TO(STAND_TOLERANCE, worst_distance_error(stood, distance));
    TEST_ASSERT_TRUE(same_handedness(stood, pose.joint));
    const float right = stood[EDML_R_ANKLE].y, left = stood[EDML_L_ANKLE].y;
    TEST_ASSERT_FLOAT_WITHIN(STAND_TOLERANCE, ANKLE, right < left ? right : left);
    const double size = sqrt((double)up.x * (double)up.x + (double)up.y * (double)up.y +
                             (double)up.z * (double)up.z);
    for (int j = 1; j < EDML_JOINTS; j++) {
        const edml_point a = pose.joint[0], b = pose.joint[j];
        const double rise = ((double)(b.x - a.x) * (double)up.x + (double)(b.y - a.y) * (double)up.y +
                             (double)(b.z - a.z) * (double)up.z) /
                            size;
        TEST_ASSERT_FLOAT_WITHIN(STAND_TOLERANCE, (float)rise, stood[j].y - stood[0].y);
    }
}

static void a_level_camera_sees_x_to_the_right_and_z_towards_itself(void)
{
    rng r = rng_seed(140);
    someone(&r);
    check_stand(point_of(0, -1, 0));
    for (int j = 0; j < EDML_JOINTS; j++) {
        TEST_ASSERT_FLOAT_WITHIN(STAND_TOLERANCE, pose.joint[j].x, stood[j].x);
        TEST_ASSERT_FLOAT_WITHIN(STAND_TOLERANCE, -pose.joint[j].z, stood[j].z);
    }
}

static void any_upwards_will_do(void)
{
    static const edml_point axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    rng r = rng_seed(141);
    for (int n = 0; n < 6; n++) {
        someone(&r);
        check_stand(axes[n]);
    }
    for (int n = 0; n < 500; n++) {
        someone(&r);
        const float size = n % 2 ? 9.8F : 100;
        check_stand(point_of(size * gauss(&r), size * gauss(&r), size * gauss(&r)));
    }
}

static void the_length_of_upwards_does_not_matter(void)
{
    rng r = rng_seed(142);
    edml_point other[EDML_JOINTS];
    someone(&r);
    check_stand(point_of(1, -4, 2));
    memcpy(other, stood, sizeof other);
    check_stand(point_of(1024, -4096, 2048));
    TEST_ASSERT_ERROR_UP_TO(STAND_TOLERANCE, worst_joint_error(stood, other));
}

/* A camera that pitches keeps its right; one that rolls turns it back. */
static void pitch_keeps_right_and_roll_is_undone(void)
{
    rng r = rng_seed(143);
    someone(&r);
    check_stand(point_of(0, -0.8F, -0.6F));
    for (int j = 0; j < EDML_JOINTS; j++)
        TEST_ASSERT_FLOAT_WITHIN(STAND_TOLERANCE, pose.joint[j].x, stood[j].x);
    check_stand(point_of(0.6F, -0.8F, 0));
    for (int j = 0; j < EDML_JOINTS; j++)
        TEST_ASSERT_FLOAT_WITHIN(STAND_TOLERANCE, -pose.joint[j].z, stood[j].z);
    check_stand(point_of(0, 1, 0)); /* upside down: half a turn */
    for (int j = 0; j < EDML_JOINTS; j++)
        TEST_ASSERT_FLOAT_WITHIN(STAND_TOLERANCE, -pose.joint[j].x, stood[j].x);
}

static void no_upwards_is_refused(void)
{
    static const float wrong[] = {NAN, INFINITY, -INFINITY};
    rng r = rng_seed(144);
    someone(&r);
    memset(stood, 0x5A, sizeof stood);
    edml_point untouched[EDML_JOINTS];
    memcpy(untouched, stood, sizeof stood);
    TEST_ASSERT_EQUAL_INT(EDML_ERR_DEGENERATE, edml_stand(stood, &pose, point_of(0, 0, 0)));
    for (int n = 0; n < 3; n++) {
        TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, edml_stand(stood, &pose, point_of(wrong[n], -1, 0)));
        TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, edml_stand(stood, &pose, point_of(0, wrong[n], 0)));
        TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, edml_stand(stood, &pose, point_of(0, -1, wrong[n])));
    }
    pose.joint[2].z = NAN;
    TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, edml_stand(stood, &pose, point_of(0, -1, 0)));
    TEST_ASSERT_EQUAL_MEMORY(untouched, stood, sizeof stood);
}

/* ---- Uncertainty ---------------------------------------------------------------------------------- */

static unsigned bits(unsigned mask)
{
    unsigned count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) count += mask >> j & 1;
    return count;
}

static uint16_t mirrored(unsigned mask)
{
    unsigned other = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        if (mask >> j & 1) other |= 1U << edml_mirror_joint[j];
    return (uint16_t)other;
}

static void every_pattern_has_errors_or_is_refused(void)
{
    uint8_t whole[EDML_JOINTS], error[EDML_JOINTS], other[EDML_JOINTS];
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_uncertainty(whole, ALL_SEEN));
    for (unsigned seen = 0; seen <= ALL_SEEN; seen++) {
        memset(error, 255, sizeof error);
        const edml_status status = edml_uncertainty(error, (uint16_t)seen);
        if (bits(seen) < 10) {
            TEST_ASSERT_EQUAL_INT(EDML_ERR_TOO_FEW_JOINTS, status);
            TEST_ASSERT_EQUAL_INT(255, error[0]);
            continue;
        }
        TEST_ASSERT_EQUAL_INT(EDML_OK, status);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_uncertainty(other, mirrored(seen)));
        for (int j = 0; j < EDML_JOINTS; j++) {
            TEST_ASSERT_TRUE(error[j] >= whole[j] && error[j] < 255);
            TEST_ASSERT_EQUAL_INT(error[j], other[edml_mirror_joint[j]]);
        }
    }
}

static void what_is_not_seen_is_less_certain(void)
{
    uint8_t whole[EDML_JOINTS], error[EDML_JOINTS], arm[EDML_JOINTS];
    const unsigned wrist = 1U << EDML_L_WRIST, elbow = 1U << EDML_L_ELBOW;
    edml_uncertainty(whole, ALL_SEEN);
    edml_uncertainty(error, (uint16_t)(ALL_SEEN & ~wrist));
    edml_uncertainty(arm, (uint16_t)(ALL_SEEN & ~wrist & ~elbow));
    TEST_ASSERT_TRUE(error[EDML_L_WRIST] > error[EDML_R_WRIST]);
    TEST_ASSERT_TRUE(error[EDML_R_WRIST] > whole[EDML_R_WRIST]);
    TEST_ASSERT_TRUE(arm[EDML_L_WRIST] > error[EDML_L_WRIST]);
    TEST_ASSERT_TRUE(arm[EDML_L_ELBOW] > arm[EDML_R_ELBOW]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(nothing_known_leaves_the_pose);
    RUN_TEST(a_height_scales_all_alike);
    RUN_TEST(known_bones_get_their_length_and_others_keep_theirs);
    RUN_TEST(with_a_height_too_the_other_bones_are_scaled);
    RUN_TEST(absurd_measures_are_refused);
    RUN_TEST(measures_of_two_people_are_refused);
    RUN_TEST(a_bone_of_nobody_is_refused);
    RUN_TEST(a_pose_that_is_none_is_refused);
    RUN_TEST(a_pose_of_quite_another_size_is_refused);
    RUN_TEST(a_sound_pose_has_a_high_quality);
    RUN_TEST(whatever_is_wrong_lowers_quality);
    RUN_TEST(the_larger_the_misfit_the_lower_the_quality);
    RUN_TEST(the_more_from_the_side_the_higher_the_quality);
    RUN_TEST(joints_anywhere_have_hardly_any_quality);
    RUN_TEST(each_missing_joint_lowers_quality_alike);
    RUN_TEST(poses_from_half_to_eight_times_the_body_are_fitted);
    RUN_TEST(heights_from_half_a_metre_are_a_body_s);
    RUN_TEST(bones_become_up_to_64_times_as_long);
    RUN_TEST(quality_costs_what_the_fit_says);
    RUN_TEST(misfits_count_up_to_half_a_metre);
    RUN_TEST(a_bone_out_of_the_range_costs_by_the_metre);
    RUN_TEST(bones_count_up_to_four_metres);
    RUN_TEST(the_view_from_the_side_gains_its_share_of_depth);
    RUN_TEST(what_no_lift_returns_has_no_quality);
    RUN_TEST(a_level_camera_sees_x_to_the_right_and_z_towards_itself);
    RUN_TEST(any_upwards_will_do);
    RUN_TEST(the_length_of_upwards_does_not_matter);
    RUN_TEST(pitch_keeps_right_and_roll_is_undone);
    RUN_TEST(no_upwards_is_refused);
    RUN_TEST(every_pattern_has_errors_or_is_refused);
    RUN_TEST(what_is_not_seen_is_less_certain);
    return UNITY_END();
}
