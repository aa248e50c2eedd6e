/* The fixed-point stages in integers that watch themselves: nothing overflows, whatever was accepted, and
 * results are those of the library bit for bit.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "helpers.h"
#include "network/model.h"
#include "overflow.h"

enum { ROOM = 1 << 29, THREE_METRES = 3 << 24 };

static edml_work_q work;
static edml_keypoint_q in[EDML_JOINTS];
static const edml_model *const models[] = {&edml_distances_w16, &edml_direct_w16, &edml_fconn_w16,
                                           &edml_distances_w8,  &edml_direct_w8,  &edml_fconn_w8};
enum { MODELS = (int)(sizeof models / sizeof models[0]) };

static checked_tally worst, total;
static long lifts;

static void keep_worst(const checked_tally *taken)
{
    if (taken->sums > worst.sums) worst.sums = taken->sums;
    if (taken->products > worst.products) worst.products = taken->products;
    if (taken->ratios > worst.ratios) worst.ratios = taken->ratios;
    if (taken->roots > worst.roots) worst.roots = taken->roots;
    total.sums += taken->sums;
    total.products += taken->products;
    total.ratios += taken->ratios;
    total.roots += taken->roots;
    lifts++;
}

static int lift_both(const edml_point_q *up, const edml_model *model)
{
    edml_pose_q expected, found;
    checked_tally taken;
    memset(&expected, 0, sizeof expected);
    memset(&found, 0, sizeof found);
    const edml_status status = edml_lift_q(&expected, in, up, model, &work, sizeof work);
    TEST_ASSERT_EQUAL_INT(status, checked_lift(&found, in, up, model, &taken));
    TEST_ASSERT_SAME_BYTES(expected, found);
    TEST_ASSERT_EQUAL_INT(0, taken.overflows);
    if (status == EDML_OK) keep_worst(&taken);
    return status == EDML_OK;
}

/* Any upward direction, of any length; NULL for one in four. */
static const edml_point_q *some_up(rng *r)
{
    static edml_point_q up;
    const int shift = 2 + (int)(rng_bits(r) % 24);
    up.x = (int32_t)rng_bits(r) >> shift;
    up.y = (int32_t)rng_bits(r) >> shift;
    up.z = (int32_t)rng_bits(r) >> shift;
    return rng_bits(r) % 4 == 0 ? NULL : &up;
}

/* ---- Lifts --------------------------------------------------------------------------------------- */

static void people(void)
{
    rng r = rng_seed(81);
    for (int n = 0; n < 2000; n++) {
        edml_point x[EDML_JOINTS];
        edml_keypoint image[EDML_JOINTS];
        random_human(&r, x);
        photograph(image, x);
        for (int j = 0; j < EDML_JOINTS; j++)
            if (n % 3 == 0 && rng_bits(&r) % 8 == 0) image[j].c = 0;
        to_q16(in, image);
        lift_both(some_up(&r), models[n % MODELS]);
    }
    printf("operations a lift, mean (largest): sums %ld (%ld), products %ld (%ld), ratios %ld (%ld), "
           "roots %ld (%ld)\n",
           total.sums / lifts, worst.sums, total.products / lifts, worst.products, total.ratios / lifts,
           worst.ratios, total.roots / lifts, worst.roots);
}

/* Anything of any size; about half is refused. */
static void scattered_joints(void)
{
    rng r = rng_seed(82);
    int lifted = 0;
    for (int n = 0; n < 20000; n++) {
        const int shift = 3 + n % 17;
        for (int j = 0; j < EDML_JOINTS; j++) {
            in[j].x = (int32_t)(rng_bits(&r) >> shift);
            in[j].y = (int32_t)(rng_bits(&r) >> shift);
            in[j].c = (int16_t)(n % 5 == 0 ? rng_bits(&r) % 4 : 1);
        }
        lifted += lift_both(some_up(&r), models[n % MODELS]);
    }
    TEST_ASSERT_TRUE(lifted > 5000);
}

/* Every joint at an edge or a corner of a wide or a high box, here and at the ends of the range: the largest
 * moments, and the largest differences. */
static void corners_of_boxes(void)
{
    rng r = rng_seed(83);
    int lifted = 0;
    for (int n = 0; n < 20000; n++) {
        const int32_t half = n % 2 ? ROOM - 1 : 120 << 16;
        const int32_t across = half / (1 + n / 2 % 3 * 2), along = half / (1 + n / 6 % 3 * 2);
        for (int j = 0; j < EDML_JOINTS; j++) {
            in[j].x = rng_bits(&r) & 1 << 16 ? across : -across;
            in[j].y = rng_bits(&r) & 1 << 16 ? along : -along;
            if (rng_bits(&r) >> 29 == 0) in[j].x = in[j].y = 0;
            in[j].c = n % 5 || rng_bits(&r) >> 29 ? 1 : 0;
        }
        lifted += lift_both(some_up(&r), models[n / 2 % MODELS]);
    }
    TEST_ASSERT_TRUE(lifted > 5000);
}

static void boxes_at_the_ends_of_the_range(void)
{
    rng r = rng_seed(84);
    for (int n = 0; n < 20000; n++) {
        for (int j = 0; j < EDML_JOINTS; j++) {
            const int32_t ends[] = {ROOM - 1, 1 - ROOM, INT32_MAX, INT32_MIN, 0, 1, -1, 1 << 16};
            const uint32_t choice = n % 4 ? 2 : 8;
            in[j].x = ends[rng_bits(&r) % choice] / (1 + n % 3);
            in[j].y = ends[(rng_bits(&r) >> 8) % choice];
            in[j].c = 1;
        }
        lift_both(some_up(&r), models[n % MODELS]);
    }
}

/* ---- Numbers that no network need give --------------------------------------------------------- */

/* Stands in for a network: gives these numbers, whatever it reads. */
static int32_t outputs[196];

static void give(int32_t *out, const int32_t *read, const edml_model *model, void *scratch)
{
    (void)read, (void)scratch;
    memcpy(out, outputs, (size_t)edml__output_values(model) * sizeof *out);
}

static void lift_what_is_given(rng *r, const edml_model *model)
{
    edml_model other = *model;
    other.predict_q = give;
    lift_both(some_up(r), &other);
}

static void check_distances(rng *r, const int32_t distance[EDML_PAIRS])
{
    int32_t x[EDML_JOINTS][3];
    checked_tally taken;
    memcpy(outputs, distance, EDML_PAIRS * sizeof *outputs);
    lift_what_is_given(r, &edml_fconn_w16);
    for (int objective = EDML_STRESS_SQUARE; objective <= EDML_STRESS_EQ2; objective++) {
        checked_refine(x, distance, (edml_objective)objective, 6, &taken);
        TEST_ASSERT_EQUAL_INT(0, taken.overflows);
    }
}

static void an_image(rng *r)
{
    edml_point x[EDML_JOINTS];
    edml_keypoint image[EDML_JOINTS];
    random_human(r, x);
    photograph(image, x);
    to_q16(in, image);
}

static void any_distances_up_to_three_metres(void)
{
    rng r = rng_seed(85);
    int32_t distance[EDML_PAIRS];
    for (int n = 0; n < 600; n++) {
        an_image(&r);
        const int shift = n % 20;
        for (int k = 0; k < EDML_PAIRS; k++)
            distance[k] = (int32_t)(rng_bits(&r) % (THREE_METRES + 1)) >> shift;
        check_distances(&r, distance);
    }
}

/* Zero or three metres: the matrices of the largest norm. */
static void distances_of_nothing_and_three_metres(void)
{
    rng r = rng_seed(86);
    int32_t distance[EDML_PAIRS];
    for (int n = 0; n < 600; n++) {
        an_image(&r);
        for (int k = 0; k < EDML_PAIRS; k++)
            distance[k] = rng_bits(&r) % 8 < (uint32_t)(n % 9) ? THREE_METRES : 0;
        check_distances(&r, distance);
    }
}

/* Two, three or four crowds: as many joints as possible in each of a few places. */
static void crowds_three_metres_apart(void)
{
    rng r = rng_seed(87);
    int32_t distance[EDML_PAIRS];
    for (int n = 0; n < 300; n++) {
        uint32_t place[EDML_JOINTS];
        an_image(&r);
        for (int j = 0; j < EDML_JOINTS; j++) place[j] = rng_bits(&r) % (uint32_t)(2 + n % 3);
        for (int i = 0; i < EDML_JOINTS; i++)
            for (int j = i + 1; j < EDML_JOINTS; j++)
                distance[EDML_PAIR(i, j)] = place[i] == place[j] ? 0 : THREE_METRES;
        check_distances(&r, distance);
    }
}

/* Up to `most` on either side of `middle`: anything, or one of the two ends. */
static int32_t some_coordinate(rng *r, int32_t middle, int32_t most, int is_end)
{
    const uint32_t bits = rng_bits(r);
    if (is_end) return bits & 1 << 16 ? middle + most : middle - most;
    return middle - most + (int32_t)(bits % (uint32_t)(2 * most + 1));
}

static edml_point_q24 some_point(rng *r, edml_point_q24 middle, int32_t most, int is_end)
{
    const edml_point_q24 p = {some_coordinate(r, middle.x, most, is_end),
                              some_coordinate(r, middle.y, most, is_end),
                              some_coordinate(r, middle.z, most, is_end)};
    return p;
}

/* Returns for how many objectives the points were moved. */
static int refine_both(const edml_point_q24 x[EDML_JOINTS], const int32_t distance[EDML_PAIRS])
{
    enum { STEPS = 14 };
    int refined = 0;
    for (int n = EDML_STRESS_SQUARE; n <= EDML_STRESS_EQ2; n++) {
        const edml_objective objective = (edml_objective)n;
        edml_point_q24 expected[EDML_JOINTS], found[EDML_JOINTS];
        checked_tally taken;
        memcpy(expected, x, sizeof expected);
        memcpy(found, x, sizeof found);
        const int steps = edml_refine_q(expected, distance, objective, STEPS, &work);
        TEST_ASSERT_EQUAL_INT(steps, checked_refine_points(found, distance, objective, STEPS, &taken));
        TEST_ASSERT_SAME_BYTES(expected, found);
        TEST_ASSERT_EQUAL_INT(0, taken.overflows);
        refined += steps > 0;
    }
    return refined;
}

/* In a heap of any size anywhere within 63 m, and distances that have nothing to do with it. */
static void refinements_of_points_anywhere(void)
{
    const int32_t metre = 1 << 24, half = THREE_METRES / 2;
    const edml_point_q24 origin = {0, 0, 0};
    rng r = rng_seed(188);
    int refined = 0;
    for (int n = 0; n < 3000; n++) {
        edml_point_q24 x[EDML_JOINTS];
        int32_t distance[EDML_PAIRS];
        const int32_t size = (int32_t)(rng_bits(&r) % (4U << 24)) >> n % 22;
        const edml_point_q24 middle = some_point(&r, origin, 63 * metre - size, n % 4 == 0);
        for (int j = 0; j < EDML_JOINTS; j++) x[j] = some_point(&r, middle, size, n % 5 == 0);
        for (int k = 0; k < EDML_PAIRS; k++)
            distance[k] = some_coordinate(&r, half, half, n % 3 == 0) >> (n % 3 == 1 ? n % 22 : 0);
        refined += refine_both(x, distance);
    }
    TEST_ASSERT_TRUE(refined > 5000);
}

/* Outputs of an equivariant network, each -3 to 3 m: anything, small ones, or nothing between; of people and
 * of joints anywhere. */
static void any_outputs_up_to_three_metres(void)
{
    rng r = rng_seed(91);
    for (int n = 0; n < 6000; n++) {
        const int shift = n % 3 ? 0 : n / 3 % 24;
        an_image(&r);
        for (int j = 0; j < EDML_JOINTS && n % 4 == 0; j++) {
            in[j].x = (int32_t)rng_bits(&r) >> 4;
            in[j].y = (int32_t)rng_bits(&r) >> 4;
        }
        for (int k = 0; k < 196; k++) {
            const uint32_t bits = rng_bits(&r);
            const int32_t ends[] = {THREE_METRES, -THREE_METRES, 0, THREE_METRES};
            outputs[k] = n % 3 == 2
                             ? ends[(bits >> 16) % (n % 2 ? 2 : 4)]
                             : ((int32_t)(bits % (2 * THREE_METRES + 1)) - THREE_METRES) / (1 << shift);
        }
        lift_what_is_given(&r, n % 2 ? &edml_distances_w16 : &edml_direct_w16);
    }
}

/* A network for which missing joints are nowhere, in an image that is not turned. */
static void networks_without_imputation(void)
{
    rng r = rng_seed(92);
    edml_model model = edml_fconn_w16;
    model.imputation = NULL;
    int lifted = 0;
    for (int n = 0; n < 5000; n++) {
        const int shift = 3 + n % 17;
        for (int j = 0; j < EDML_JOINTS; j++) {
            in[j].x = (int32_t)rng_bits(&r) >> shift;
            in[j].y = (int32_t)rng_bits(&r) >> shift;
            in[j].c = (int16_t)(rng_bits(&r) >> 29);
        }
        lifted += lift_both(some_up(&r), &model);
    }
    TEST_ASSERT_TRUE(lifted > 1000);
}

/* ---- Placements ---------------------------------------------------------------------------------- */

static int place_both(const edml_pose *pose, const edml_camera *by)
{
    edml_placement_q expected, found;
    edml_pose_q given;
    checked_tally taken;
    const edml_camera_q camera = camera_to_q16(*by);
    pose_to_q16(&given, pose);
    memset(&expected, 0, sizeof expected);
    memset(&found, 0, sizeof found);
    const edml_status status = edml_place_q(&expected, &given, in, &camera, &work, sizeof work);
    TEST_ASSERT_EQUAL_INT(status, checked_place(&found, &given, in, &camera, &taken));
    TEST_ASSERT_SAME_BYTES(expected, found);
    TEST_ASSERT_EQUAL_INT(0, taken.overflows);
    return status == EDML_OK;
}

static float magnitude(rng *r, float least, float most)
{
    return least * powf(most / least, uniform(r, 0, 1));
}

/* Someone before a camera of any kind, near or far; or a pose and an image that are not the same. */
static void random_scene(rng *r, int n, edml_pose *pose, edml_camera *by)
{
    edml_keypoint image[EDML_JOINTS];
    edml_point x[EDML_JOINTS];
    const float depth = magnitude(r, 1, 150), noise = n % 4 < 2 ? 0 : magnitude(r, 0.1F, 100);
    by->fx = magnitude(r, 100, 6000);
    by->fy = by->fx * uniform(r, 0.5F, 2);
    by->cx = uniform(r, -1000, 3000);
    by->cy = uniform(r, -1000, 3000);
    random_human(r, x);
    rotate_points(x, random_rotation(r), x);
    memcpy(pose->joint, x, sizeof x);
    if (n % 8 == 7) random_points(r, pose->joint, magnitude(r, 0.01F, 4));
    if (n % 8 == 5) pose->joint[rng_bits(r) % EDML_JOINTS].z = uniform(r, -4, 4);
    rotate_points(pose->joint, random_rotation(r), pose->joint);
    const float across = uniform(r, -1, 1), down = uniform(r, -1, 1);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const float z = x[j].z + depth > 0.1F ? x[j].z + depth : 0.1F;
        image[j].x = by->cx + by->fx * (x[j].x + across * depth) / z + noise * gauss(r);
        image[j].y = by->cy + by->fy * (x[j].y + down * depth) / z + noise * gauss(r);
        image[j].c = n % 3 == 0 ? 1 : uniform(r, -0.2F, 1) * (rng_bits(r) % 8 == 0 ? 0.002F : 1);
    }
    to_q16(in, image);
}

static void placements(void)
{
    rng r = rng_seed(86);
    int placed = 0;
    for (int n = 0; n < 5000; n++) {
        edml_pose pose;
        edml_camera by;
        random_scene(&r, n, &pose, &by);
        placed += place_both(&pose, &by);
    }
    printf("check: %d of 5000 placed\n", placed);
    TEST_ASSERT_TRUE(placed > 2500);
}

/* The same scenes lifted by a camera that is known. */
static void lifts_with_a_camera(void)
{
    rng r = rng_seed(93);
    int lifted = 0;
    for (int n = 0; n < 5000; n++) {
        edml_pose pose;
        edml_camera by;
        edml_pose_q expected, found;
        checked_tally taken;
        random_scene(&r, n, &pose, &by);
        memset(&expected, 0, sizeof expected);
        memset(&found, 0, sizeof found);
        const edml_camera_q camera = camera_to_q16(by);
        const edml_model *const model = models[n % MODELS];
        const edml_point_q *const up = some_up(&r);
        const edml_status status = edml_lift_with_camera_q(&expected, in, up, &camera, model, &work,
                                                           sizeof work);
        TEST_ASSERT_EQUAL_INT(status, checked_lift_with_camera(&found, in, up, &camera, model, &taken));
        TEST_ASSERT_EQUAL_MEMORY(&expected, &found, offsetof(edml_pose_q, seen)); /* no padding */
        TEST_ASSERT_EQUAL_INT(expected.seen, found.seen);
        TEST_ASSERT_EQUAL_INT(0, taken.overflows);
        lifted += status == EDML_OK;
    }
    TEST_ASSERT_TRUE(lifted > 2000);
}

/* Anything at all, in an image of a quarter pixel or of the whole range. */
static void placements_of_noise(void)
{
    rng r = rng_seed(87);
    for (int n = 0; n < 5000; n++) {
        const int shift = (int)(rng_bits(&r) % 16);
        edml_pose pose;
        random_points(&r, pose.joint, magnitude(&r, 0.01F, 4));
        const edml_camera by = {magnitude(&r, 0.01F, 8191), magnitude(&r, 0.01F, 8191), 0, 0};
        for (int j = 0; j < EDML_JOINTS; j++) {
            in[j].x = (int32_t)rng_bits(&r) >> shift;
            in[j].y = (int32_t)rng_bits(&r) >> shift;
            in[j].c = (int16_t)(rng_bits(&r) % 32768);
        }
        place_both(&pose, &by);
    }
}

/* Points nearly on a line, or nearly in a plane: where the equations of a placement hardly have a solution.
 * The image is that of the points, of a person, or of some other line. */
static void placements_of_points_nearly_on_a_line(void)
{
    rng r = rng_seed(94);
    int placed = 0;
    for (int n = 0; n < 20000; n++) {
        edml_pose pose;
        edml_point image[EDML_JOINTS];
        const float along = magnitude(&r, 0.05F, 3.9F), aside = n % 2 ? 0 : magnitude(&r, 1e-4F, 1);
        const float across = magnitude(&r, 1e-5F, 0.3F), depth = magnitude(&r, 1, 60);
        const edml_camera by = {magnitude(&r, 100, 4000), magnitude(&r, 100, 4000), 320, 240};
        for (int j = 0; j < EDML_JOINTS; j++) {
            pose.joint[j].x = along * uniform(&r, -0.5F, 0.5F);
            pose.joint[j].y = aside * uniform(&r, -0.5F, 0.5F);
            pose.joint[j].z = across * uniform(&r, -0.5F, 0.5F);
        }
        rotate_points(pose.joint, random_rotation(&r), pose.joint);
        if (n % 3 == 0) random_human(&r, image);
        rotate_points(image, random_rotation(&r), n % 3 == 0 ? image : pose.joint);
        for (int j = 0; j < EDML_JOINTS; j++) {
            const float z = image[j].z + depth > 0.3F ? image[j].z + depth : 0.3F;
            if (n % 3 == 2) image[j].y = 0.3F * image[j].x + across * gauss(&r);
            in[j].x = (int32_t)(65536 * (by.cx + by.fx * image[j].x / z));
            in[j].y = (int32_t)(65536 * (by.cy + by.fy * image[j].y / z));
            in[j].c = (int16_t)(n % 5 ? 32767 : rng_bits(&r) % 32768);
        }
        placed += place_both(&pose, &by);
    }
    TEST_ASSERT_TRUE(placed > 2000);
}

static void place_known(const edml_pose_q *points, const edml_keypoint_q image[EDML_JOINTS], edml_camera by)
{
    edml_pose pose;
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose.joint[j].x = (float)points->joint[j].x / 65536;
        pose.joint[j].y = (float)points->joint[j].y / 65536;
        pose.joint[j].z = (float)points->joint[j].z / 65536;
    }
    memcpy(in, image, sizeof in);
    place_both(&pose, &by);
}

/* Fourteen points of which one coordinate of a step did overflow, before it was limited. */
static void a_placement_that_did_overflow(void)
{
    static const edml_pose_q points = {{{-40808, -3370, 7938},    {55244, 4487, -10765},
                                        {-28049, -2210, 5489},    {-29052, -2371, 5627},
                                        {19056, 1530, -3690},     {68215, 5567, -13280},
                                        {52760, 4330, -10213},    {105413, 8606, -20485},
                                        {-81057, -6620, 15752},   {148198, 12080, -28874},
                                        {-39765, -3286, 7771},    {45143, 3690, -8755},
                                        {46069, 3787, -8903},     {-14608, -1162, 2861}},
                                       0,
                                       0};
    static const edml_keypoint_q image[EDML_JOINTS] = {
        {20815805, 13173981, 6215},  {20904454, 13950598, 32767}, {20427602, 14248011, 32767},
        {19983334, 14837785, 19578}, {20476043, 15535778, 32767}, {21496126, 14119190, 162},
        {21659585, 14989995, 32767}, {21854358, 15426979, 4379},  {20685668, 15691430, 32767},
        {20541285, 17128764, 166},   {20500717, 18291103, 20187}, {21323905, 15588899, 32767},
        {21360544, 17016730, 32767}, {21527946, 18285539, 32767}};
    const edml_camera by = {6093584 / 65536.0F, 6093584 / 65536.0F, 320, 240};
    place_known(&points, image, by);
}

/* Fourteen points, no person's, whose normal equations in the image have the largest entries that a search
 * found: about 84, where they are clamped to 64. */
static void a_placement_with_large_normal_equations(void)
{
    static const edml_pose_q points = {{{1458, 1453, -1453},
                                        {-6709, 1464, 1866},
                                        {-1156, 1231, 1628},
                                        {899, 1383, 2378},
                                        {-1543, -1124, 1537},
                                        {1494, 1400, -1447},
                                        {-1432, 614, 1479},
                                        {38236, -108104, 150537},
                                        {1407, -1408, -1537},
                                        {1702, -1764, -1482},
                                        {1366, -1389, 1635},
                                        {0, 1857, 1515},
                                        {1867, 994, 1690},
                                        {1168, -1426, -788}},
                                       0,
                                       0};
    static const edml_keypoint_q image[EDML_JOINTS] = {
        {135568641, 108232379, 29206}, {55504886, 38835811, 3383},    {1049515, 35339638, 26499},
        {58430546, 25647458, 8073},    {657393, -43227333, 11042},    {133912436, 109774884, 32767},
        {1616082, 27879750, 9018},     {34687610, -124499950, 29},    {135307190, -107965289, 32767},
        {139253070, -108233619, 32767}, {56736869, -30561896, 1350},  {54952530, 24728089, 14549},
        {60755222, 17201529, 286},     {139161108, -108842395, 11177}};
    const edml_camera by = {69626536 / 65536.0F, 69626536 / 65536.0F, 0, 0};
    place_known(&points, image, by);
}

static void placements_with_unknown_focal_length(void)
{
    rng r = rng_seed(90);
    int placed = 0;
    for (int n = 0; n < 500; n++) {
        edml_pose pose;
        edml_camera by;
        edml_pose_q given;
        edml_placement_q expected, found;
        edml_camera_q camera, other;
        checked_tally taken;
        random_scene(&r, n, &pose, &by);
        pose_to_q16(&given, &pose);
        memset(&expected, 0, sizeof expected);
        memset(&found, 0, sizeof found);
        memset(&camera, 0, sizeof camera);
        memset(&other, 0, sizeof other);
        const int32_t width = (int32_t)(rng_bits(&r) >> 2), height = (int32_t)(rng_bits(&r) >> (2 + n % 5));
        const edml_status status = edml_place_sweep_q(&expected, &camera, &given, in, width, height, &work,
                                                      sizeof work);
        TEST_ASSERT_EQUAL_INT(status,
                              checked_place_sweep(&found, &other, &given, in, width, height, &taken));
        TEST_ASSERT_EQUAL_MEMORY(&expected, &found, offsetof(edml_placement_q, steps)); /* no padding */
        TEST_ASSERT_EQUAL_INT(expected.steps, found.steps);
        TEST_ASSERT_SAME_BYTES(camera, other);
        TEST_ASSERT_EQUAL_INT(0, taken.overflows);
        placed += status == EDML_OK;
    }
    TEST_ASSERT_TRUE(placed > 50);
}

/* The search for one focal length goes on over poses of any kind; and paths, over placements anywhere. */
static void searches_for_a_focal_length(void)
{
    rng r = rng_seed(94);
    edml_focal_q expected;
    int added = 0;
    for (int n = 0; n < 300; n++) {
        edml_pose pose;
        edml_camera by;
        edml_pose_q given;
        edml_camera_q camera, other;
        checked_tally taken;
        const int32_t width = (int32_t)(rng_bits(&r) >> 3), height = (int32_t)(rng_bits(&r) >> (3 + n % 5));
        if (n % 20 == 0)
            TEST_ASSERT_EQUAL_INT(EDML_OK, edml_focal_start_q(&expected, width | 1, height | 1));
        random_scene(&r, n, &pose, &by);
        pose_to_q16(&given, &pose);
        edml_focal_q found = expected;
        memset(&camera, 0, sizeof camera);
        memset(&other, 0, sizeof other);
        edml_status status = edml_focal_add_q(&expected, &given, in, &work, sizeof work);
        if (status == EDML_OK) status = edml_focal_camera_q(&camera, &expected);
        TEST_ASSERT_EQUAL_INT(status, checked_focal_add(&found, &other, &given, in, &taken));
        TEST_ASSERT_SAME_BYTES(expected, found);
        TEST_ASSERT_SAME_BYTES(camera, other);
        TEST_ASSERT_EQUAL_INT(0, taken.overflows);
        added += status == EDML_OK;
    }
    TEST_ASSERT_TRUE(added > 50);
}

/* People anywhere in reach, who stay, walk, leap, and are seen at any times. */
static void paths_anywhere(void)
{
    rng r = rng_seed(95);
    edml_path_q expected;
    edml_placement_q placement, other;
    edml_point at = {0, 0, 10};
    uint32_t time = 0;
    int followed = 0;
    edml_path_start_q(&expected);
    memset(&placement, 0, sizeof placement);
    for (int n = 0; n < 50000; n++) {
        const float most = n % 3 == 0 ? 105 : 10, step = magnitude(&r, 0.001F, n % 7 == 0 ? 20 : 1);
        checked_tally taken;
        if (n % 50 == 0) {
            at.x = uniform(&r, -most, most);
            at.y = uniform(&r, -most, most);
            at.z = uniform(&r, 0.01F, most);
        }
        if (n % 1000 == 999) at.x = at.y = at.z = 99.99F;
        const edml_point near = {at.x + step * gauss(&r), at.y + step * gauss(&r), at.z + step * gauss(&r)};
        placement.translation = point_to_q16(near);
        for (int j = 0; j < EDML_JOINTS; j++) placement.joint[j] = placement.translation;
        time += 1 + (rng_bits(&r) >> (n % 100 < 50 ? 26 : 22));
        edml_path_q path = expected;
        other = placement;
        const edml_status status = edml_path_follow_q(&expected, &placement, time);
        TEST_ASSERT_EQUAL_INT(status, checked_path_follow(&path, &other, time, &taken));
        TEST_ASSERT_EQUAL_MEMORY(&expected, &path, offsetof(edml_path_q, placements)); /* no padding */
        TEST_ASSERT_EQUAL_INT(expected.placements, path.placements);
        TEST_ASSERT_EQUAL_MEMORY(&placement, &other, offsetof(edml_placement_q, steps));
        TEST_ASSERT_EQUAL_INT(0, taken.overflows);
        followed += status == EDML_OK;
    }
    TEST_ASSERT_TRUE(followed > 20000);
}

/* ---- Videos -------------------------------------------------------------------------------------- */

/* The next frame: someone who moves, and is seen worse and worse; or anything, here or at the ends of the
 * range. */
static void some_frame(rng *r, int n, const edml_point x[EDML_JOINTS])
{
    edml_keypoint image[EDML_JOINTS];
    edml_point turned[EDML_JOINTS];
    const uint32_t kind = rng_bits(r) % 16;
    const int shift = 3 + (int)(rng_bits(r) % 20), right = kind % 2 ? EDML_R_SHOULDER : EDML_R_HIP;
    rotate_points(turned, random_rotation(r), x);
    photograph(image, n % 8 == 7 ? turned : x);
    to_q16(in, image);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x += (int32_t)rng_bits(r) >> (10 + n % 20);
        in[j].y += (int32_t)rng_bits(r) >> (10 + n % 20);
        if (rng_bits(r) % 16 == 0) in[j].c = 0;
        const int ends = kind == 15 && n % 4;
        if (kind >= 14 && rng_bits(r) % 2) in[j].x = ends ? ROOM - 1 : (int32_t)rng_bits(r) >> shift;
        if (kind >= 14 && rng_bits(r) % 2) in[j].y = ends ? 1 - ROOM : (int32_t)rng_bits(r) >> shift;
    }
    for (int j = right; j < right + 3 && kind < 4; j++) {
        const edml_keypoint_q other = in[j];
        in[j] = in[edml_mirror_joint[j]];
        in[edml_mirror_joint[j]] = other;
    }
}

static void some_settings(rng *r, int n, edml_track_q *track)
{
    if (n % 3 == 0) return;
    track->smooth_image.cutoff = 1 + (int32_t)(rng_bits(r) >> (1 + rng_bits(r) % 30));
    track->smooth_space.cutoff = n % 3 == 1 ? INT32_MAX : (1 << 27) - 1;
    track->smooth_image.slope = (int32_t)(rng_bits(r) % ((32 << 16) + 1));
    track->smooth_space.slope = n % 2 ? 32 << 16 : 0;
    track->noise_full = (int32_t)(rng_bits(r) % ((64 << 16) + 1)) >> rng_bits(r) % 23;
}

static int follow_both(edml_track_q *track, uint32_t time_ms, const edml_model *model)
{
    edml_pose_q expected, found;
    checked_tally taken;
    int32_t other;
    memset(&expected, 0, sizeof expected);
    memset(&found, 0, sizeof found);
    const int32_t distance = edml_track_distance_q(track, in, time_ms);
    const edml_status status = edml_track_lift_q(&expected, track, in, time_ms, NULL, model, &work,
                                                 sizeof work);
    TEST_ASSERT_EQUAL_INT(status, checked_track_lift(&found, &other, in, time_ms, model, &taken));
    TEST_ASSERT_SAME_BYTES(expected, found);
    TEST_ASSERT_EQUAL_INT32(distance, other);
    TEST_ASSERT_EQUAL_INT(0, taken.overflows);
    return status == EDML_OK;
}

static void videos(void)
{
    rng r = rng_seed(94);
    int lifted = 0;
    for (int n = 0; n < 400; n++) {
        edml_point x[EDML_JOINTS];
        edml_track_q track;
        uint32_t time_ms = rng_bits(&r);
        edml_track_start_q(&track);
        some_settings(&r, n, &track);
        checked_track_start(&track);
        random_human(&r, x);
        for (int frame = 0; frame < 30; frame++) {
            const uint32_t steps[] = {0, 1, 33, 67, 300, 1000, 1001};
            some_frame(&r, n, x);
            lifted += follow_both(&track, time_ms, models[n % MODELS]);
            time_ms += n % 2 ? 33 : steps[rng_bits(&r) % 7];
            for (int j = 0; j < EDML_JOINTS; j++) x[j].x += 0.02F * gauss(&r);
        }
    }
    printf("check: %d of 12000 frames lifted\n", lifted);
    TEST_ASSERT_TRUE(lifted > 6000);
}

/* ---- Bodies, their quality, and on the floor --------------------------------------------------------- */

static void same_fit_and_quality(const edml_pose_q *pose, const edml_body_q *body)
{
    checked_tally taken;
    edml_pose_q expected = *pose, found = *pose;
    int32_t quality = -1, other = -1;
    TEST_ASSERT_EQUAL_INT(edml_fit_body_q(&expected, body), checked_fit_body(&found, body, &taken));
    TEST_ASSERT_SAME_BYTES(expected, found);
    TEST_ASSERT_EQUAL_INT(0, taken.overflows);
    TEST_ASSERT_EQUAL_INT(edml_quality_q(&quality, pose), checked_quality(&other, pose, &taken));
    TEST_ASSERT_EQUAL_INT32(quality, other);
    TEST_ASSERT_EQUAL_INT(0, taken.overflows);
}

static void same_measure(edml_measured_body_q *measured, const edml_pose_q *pose)
{
    checked_tally taken;
    edml_measured_body_q found = *measured;
    TEST_ASSERT_EQUAL_INT(edml_measure_body_q(measured, pose), checked_measure_body(&found, pose, &taken));
    TEST_ASSERT_EQUAL_MEMORY(measured, &found, sizeof found);
    TEST_ASSERT_EQUAL_INT(0, taken.overflows);
}

static void same_stand(const edml_pose_q *pose, edml_point_q up)
{
    checked_tally taken;
    edml_point_q expected[EDML_JOINTS], found[EDML_JOINTS];
    memset(expected, 0, sizeof expected);
    memset(found, 0, sizeof found);
    TEST_ASSERT_EQUAL_INT(edml_stand_q(expected, pose, up), checked_stand(found, pose, up, &taken));
    TEST_ASSERT_SAME_BYTES(expected, found);
    TEST_ASSERT_EQUAL_INT(0, taken.overflows);
}

static void same_angles(const edml_pose_q *pose, const edml_point_q *up)
{
    checked_tally taken;
    int32_t expected[EDML_ANGLES], found[EDML_ANGLES];
    memset(expected, 0, sizeof expected);
    memset(found, 0, sizeof found);
    TEST_ASSERT_EQUAL_INT(edml_angles_q(expected, pose, up), checked_angles(found, pose, up, &taken));
    TEST_ASSERT_SAME_BYTES(expected, found);
    TEST_ASSERT_EQUAL_INT(0, taken.overflows);
}

static void same_joint_limits(const edml_pose_q *pose)
{
    checked_tally taken;
    edml_pose_q expected = *pose, found = *pose;
    int count = -1, other = -1;
    TEST_ASSERT_EQUAL_INT(edml_joint_limits_q(&count, pose), checked_joint_limits(&other, pose, &taken));
    TEST_ASSERT_EQUAL_INT(count, other);
    TEST_ASSERT_EQUAL_INT(0, taken.overflows);
    TEST_ASSERT_EQUAL_INT(edml_reflect_by_joint_limits_q(&count, &expected),
                          checked_reflect_by_joint_limits(&other, &found, &taken));
    TEST_ASSERT_EQUAL_INT(count, other);
    TEST_ASSERT_SAME_BYTES(expected, found);
    TEST_ASSERT_EQUAL_INT(0, taken.overflows);
}

/* Joints anywhere within reach, or at its ends; measures of people, or anything; upwards of any bits. */
static void poses_of_any_size(void)
{
    rng r = rng_seed(88);
    edml_measured_body_q measured;
    for (int n = 0; n < 20000; n++) {
        if (n % 80 == 0) edml_measure_start_q(&measured);
        edml_pose pose;
        edml_pose_q given;
        edml_body_q body;
        memset(&body, 0, sizeof body);
        memset(&pose, 0, sizeof pose);
        const int shift = (int)(rng_bits(&r) % 20);
        random_points(&r, pose.joint, n % 3 == 0 ? 4 : magnitude(&r, 0.001F, 4));
        for (int j = 0; j < EDML_JOINTS && n % 5 == 0; j++)
            if (rng_bits(&r) % 2) pose.joint[j].y = rng_bits(&r) % 2 ? 3.9999F : -3.9999F;
        pose_to_q16(&given, &pose);
        given.misfit = (int32_t)(rng_bits(&r) >> (1 + shift));
        given.seen = (uint16_t)(ALL_SEEN & ~(1U << rng_bits(&r) % 16));
        if (n % 2) body.height = (int32_t)(65536 * uniform(&r, 0.5F, 2.5F));
        for (int k = 0; k < EDML_BONES; k++)
            if (n % 7 < 3 && rng_bits(&r) % 2) body.bone[k] = (int32_t)(65536 * uniform(&r, 0.1F, 0.5F));
        if (n % 11 == 0) body.bone[n % EDML_BONES] = (int32_t)rng_bits(&r) >> shift;
        const edml_point_q up = {(int32_t)rng_bits(&r) >> shift, (int32_t)rng_bits(&r) >> shift,
                                 (int32_t)rng_bits(&r) >> shift};
        same_fit_and_quality(&given, &body);
        same_measure(&measured, &given);
        same_stand(&given, up);
        same_joint_limits(&given);
        same_angles(&given, n % 4 ? &up : NULL);
        given.seen = ALL_SEEN;
        same_angles(&given, n % 4 ? &up : NULL);
    }
}

/* ---- Detectors' keypoints ---------------------------------------------------------------------------- */

/* Coordinates anywhere in the range, at its ends or beyond. */
static void keypoints_of_any_detector(void)
{
    rng r = rng_seed(89);
    edml_keypoint_q given[33], expected[EDML_JOINTS], found[EDML_JOINTS];
    memset(given, 0, sizeof given);
    memset(expected, 0, sizeof expected);
    memset(found, 0, sizeof found);
    int formats = 0;
    while (edml_formats[formats] != NULL) formats++;
    for (int n = 0; n < 20000; n++) {
        const edml_format *const format = edml_formats[n % formats];
        const int32_t ends[] = {ROOM - 1, 1 - ROOM, ROOM, INT32_MIN};
        checked_tally taken;
        for (int k = 0; k < format->keypoints; k++) {
            const uint32_t choice = rng_bits(&r);
            given[k].x = n % 3 == 0 ? ends[choice % (n % 2 ? 2 : 4)] : (int32_t)rng_bits(&r) / 4;
            given[k].y = n % 3 == 0 ? ends[choice / 4 % 2] : (int32_t)rng_bits(&r) / 4;
            given[k].c = (int16_t)(rng_bits(&r) % 8 ? rng_bits(&r) >> 17 : 0);
        }
        edml_adapt_q(expected, given, format);
        checked_adapt(found, given, format, &taken);
        for (int j = 0; j < EDML_JOINTS; j++)
            TEST_ASSERT_TRUE(expected[j].x == found[j].x && expected[j].y == found[j].y &&
                             expected[j].c == found[j].c);
        TEST_ASSERT_EQUAL_INT(0, taken.overflows);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(people);
    RUN_TEST(scattered_joints);
    RUN_TEST(corners_of_boxes);
    RUN_TEST(boxes_at_the_ends_of_the_range);
    RUN_TEST(any_distances_up_to_three_metres);
    RUN_TEST(distances_of_nothing_and_three_metres);
    RUN_TEST(crowds_three_metres_apart);
    RUN_TEST(refinements_of_points_anywhere);
    RUN_TEST(any_outputs_up_to_three_metres);
    RUN_TEST(networks_without_imputation);
    RUN_TEST(placements);
    RUN_TEST(placements_of_noise);
    RUN_TEST(placements_of_points_nearly_on_a_line);
    RUN_TEST(a_placement_that_did_overflow);
    RUN_TEST(a_placement_with_large_normal_equations);
    RUN_TEST(placements_with_unknown_focal_length);
    RUN_TEST(lifts_with_a_camera);
    RUN_TEST(searches_for_a_focal_length);
    RUN_TEST(paths_anywhere);
    RUN_TEST(poses_of_any_size);
    RUN_TEST(keypoints_of_any_detector);
    RUN_TEST(videos);
    return UNITY_END();
}
