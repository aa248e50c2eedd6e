/* optional/camera: poses placed before a camera.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "as_float.h"

static edml_work work;
static edml_point person[EDML_JOINTS]; /* in the camera's axes, origin at its centre */
static edml_pose pose;                 /* the same, turned and moved */
static rotation3 turn;                 /* ... so that pose = turn (person - root) */
static edml_point root;
static edml_keypoint in[EDML_JOINTS];
static edml_camera camera;
static edml_placement placement;

static const edml_camera usual = {1145, 1145, 500, 500};

/* ---- Cameras and people ------------------------------------------------------------------------ */

static void see(edml_keypoint out[EDML_JOINTS], const edml_camera *by, const edml_point x[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double depth = (double)x[j].z;
        out[j].x = (float)((double)by->cx + (double)by->fx * (double)x[j].x / depth);
        out[j].y = (float)((double)by->cy + (double)by->fy * (double)x[j].y / depth);
        out[j].c = 1;
    }
}

/* The pose of the person about a point, in some axes. */
static void take_pose(edml_point about, rotation3 by)
{
    root = about;
    turn = by;
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose.joint[j].x = person[j].x - about.x;
        pose.joint[j].y = person[j].y - about.y;
        pose.joint[j].z = person[j].z - about.z;
    }
    rotate_points(pose.joint, by, pose.joint);
}

static void stand_at(float x, float y, float z)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        person[j].x += x;
        person[j].y += y;
        person[j].z += z;
    }
}

static edml_point mid_hip(void)
{
    const edml_point r = person[EDML_R_HIP], l = person[EDML_L_HIP];
    const edml_point middle = {(r.x + l.x) / 2, (r.y + l.y) / 2, (r.z + l.z) / 2};
    return middle;
}

/* Someone, turned at random, somewhere before a camera of some kind, and the pose in any axes. */
static void someone_somewhere(rng *r, float nearest, float farthest)
{
    const float focal = uniform(r, 600, 1500), depth = uniform(r, nearest, farthest);
    const edml_camera some = {focal, focal * uniform(r, 0.8F, 1.25F), uniform(r, 300, 900),
                              uniform(r, 200, 700)};
    camera = some;
    random_human(r, person);
    rotate_points(person, random_rotation(r), person);
    stand_at(depth * uniform(r, -0.5F, 0.5F), depth * uniform(r, -0.4F, 0.4F), depth);
    take_pose(mid_hip(), random_rotation(r));
    see(in, &camera, person);
}

static void hide(rng *r, int joints)
{
    while (joints > 0) {
        edml_keypoint *one = &in[rng_bits(r) % EDML_JOINTS];
        if (!(one->c > 0)) continue;
        one->c = 0;
        one->x = one->y = NAN;
        joints--;
    }
}

static void run(void)
{
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_place(&placement, &pose, in, &camera, &work, sizeof work));
}

/* Degrees between the rotation found and the one that undoes `turn`. */
static float rotation_error(void)
{
    double square = 0;
    for (int i = 0; i < 3; i++) {
        const double row[3] = {(double)placement.rotation[i].x, (double)placement.rotation[i].y,
                               (double)placement.rotation[i].z};
        for (int j = 0; j < 3; j++) square += (row[j] - turn.at[j][i]) * (row[j] - turn.at[j][i]);
    }
    return (float)(sqrt(square / 2) * 180 / 3.14159265358979); /* of small angles */
}

/* Relative to the distance. */
static float translation_error(void)
{
    const edml_point origin = {0, 0, 0};
    return (float)(distance_between(placement.translation, root) / distance_between(root, origin));
}

/* ---- Exact points ------------------------------------------------------------------------------ */

/* Poses come in any axes: the iteration starts at random. */
static void exact_points_are_found_again(void)
{
    rng r = rng_seed(71);
    float angle = 0, shift = 0, pixels = 0;
    int steps = 0;
    for (int n = 0; n < 1000; n++) {
        someone_somewhere(&r, 2, 12);
        hide(&r, n % 8);
        run();
        angle = worse(angle, rotation_error());
        shift = worse(shift, translation_error());
        pixels = worse(pixels, placement.reprojection);
        if (placement.steps > steps) steps = placement.steps;
    }
    printf("camera: 1000 exact poses, at worst %.5f degrees, %.5f %% of the distance, %.5f pixels, "
           "%d steps\n",
           (double)angle, (double)(100 * shift), (double)pixels, steps);
    TEST_ASSERT_ERROR_UP_TO(PLACE_DEGREES, angle);
    TEST_ASSERT_ERROR_UP_TO(PLACE_RELATIVE, shift);
    TEST_ASSERT_ERROR_UP_TO(PLACE_PIXELS, pixels);
    TEST_ASSERT_TRUE(steps <= 53);
}

static void near_and_far_people_are_found_again(void)
{
    rng r = rng_seed(72);
    for (int n = 0; n < 200; n++) {
        someone_somewhere(&r, n % 2 ? 1.6F : 20, n % 2 ? 2 : 60);
        run();
        TEST_ASSERT_ERROR_UP_TO(PLACE_FAR_DEGREES, rotation_error());
        TEST_ASSERT_ERROR_UP_TO(PLACE_FAR_RELATIVE, translation_error());
    }
}

static void joints_are_turned_and_moved_as_it_says(void)
{
    rng r = rng_seed(73);
    for (int n = 0; n < 50; n++) {
        someone_somewhere(&r, 3, 6);
        hide(&r, 3);
        run();
        const edml_point *m = placement.rotation, t = placement.translation;
        for (int j = 0; j < EDML_JOINTS; j++) { /* those that were not seen, too */
            const edml_point p = pose.joint[j];
            const edml_point q = {m[0].x * p.x + m[0].y * p.y + m[0].z * p.z + t.x,
                                  m[1].x * p.x + m[1].y * p.y + m[1].z * p.z + t.y,
                                  m[2].x * p.x + m[2].y * p.y + m[2].z * p.z + t.z};
            TEST_ASSERT_ERROR_UP_TO(PLACE_JOINT, (float)distance_between(q, placement.joint[j]));
        }
        TEST_ASSERT_ERROR_UP_TO(PLACE_JOINT, worst_joint_error(placement.joint, person));
    }
}

/* Nobody is this flat.  Where the image hardly says which of the two tilts it is, some find the other. */
static void flat_people_are_seen_where_they_were(void)
{
    rng r = rng_seed(74);
    int lost = 0;
    for (int n = 0; n < 500; n++) {
        camera = usual;
        random_human(&r, person);
        for (int j = 0; j < EDML_JOINTS; j++) person[j].z = 0;
        if (n > 0) rotate_points(person, random_rotation(&r), person);
        stand_at(0, 0, 4);
        take_pose(mid_hip(), random_rotation(&r));
        see(in, &camera, person);
        const edml_status status = edml_place(&placement, &pose, in, &camera, &work, sizeof work);
        if (status == EDML_ERR_DEGENERATE) continue; /* edge on: the image is a line */
        TEST_ASSERT_EQUAL_INT(EDML_OK, status);
        if (placement.reprojection > PLACE_FLAT_PIXELS || translation_error() > PLACE_FLAT_RELATIVE) lost++;
    }
    printf("camera: 500 people without depth, %d lost\n", lost);
    TEST_ASSERT_TRUE(lost <= PLACE_FLAT_LOST);
}

/* ---- Noise ------------------------------------------------------------------------------------- */

static void add_noise(rng *r, float pixels)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x += pixels * gauss(r);
        in[j].y += pixels * gauss(r);
        in[j].c = uniform(r, 0.2F, 1);
    }
}

/* Weighted RMS of a rotation and translation, in double. */
static double reprojection(const edml_point m[3], edml_point t)
{
    double sum = 0, all = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double p[3] = {(double)pose.joint[j].x, (double)pose.joint[j].y, (double)pose.joint[j].z};
        double q[3] = {(double)t.x, (double)t.y, (double)t.z};
        for (int i = 0; i < 3; i++)
            q[i] += (double)m[i].x * p[0] + (double)m[i].y * p[1] + (double)m[i].z * p[2];
        const double x = (double)camera.cx + (double)camera.fx * q[0] / q[2] - (double)in[j].x;
        const double y = (double)camera.cy + (double)camera.fy * q[1] / q[2] - (double)in[j].y;
        sum += (double)in[j].c * (x * x + y * y);
        all += (double)in[j].c;
    }
    return sqrt(sum / all);
}

/* With square pixels, what is minimised are distances in the image. */
static void no_place_nearby_is_better(void)
{
    rng r = rng_seed(75);
    for (int n = 0; n < 100; n++) {
        someone_somewhere(&r, 3, 6);
        camera.fy = camera.fx;
        see(in, &camera, person);
        add_noise(&r, 5);
        run();
        const double least = reprojection(placement.rotation, placement.translation);
        TEST_ASSERT_ERROR_UP_TO(PLACE_NOISY_PIXELS, (float)least - placement.reprojection);
        for (int k = 0; k < 20; k++) {
            const edml_point t = placement.translation, a = placement.rotation[0];
            const edml_point moved = {t.x + 0.01F * gauss(&r), t.y + 0.01F * gauss(&r),
                                      t.z + 0.05F * gauss(&r)};
            const float c = 1 - 0.00045F, s = 0.03F; /* about an axis of the pose's */
            const int axis = k % 3, other = (k + 1) % 3;
            edml_point m[3] = {a, placement.rotation[1], placement.rotation[2]};
            const edml_point u = m[axis], v = m[other];
            const float side = k % 2 ? s : -s;
            const edml_point turned_u = {c * u.x - side * v.x, c * u.y - side * v.y, c * u.z - side * v.z};
            const edml_point turned_v = {c * v.x + side * u.x, c * v.y + side * u.y, c * v.z + side * u.z};
            m[axis] = turned_u;
            m[other] = turned_v;
            TEST_ASSERT_TRUE(reprojection(placement.rotation, moved) > least - 1e-3);
            TEST_ASSERT_TRUE(reprojection(m, moved) > least - 1e-3);
        }
    }
}

static void the_axes_of_the_pose_do_not_matter(void)
{
    rng r = rng_seed(76);
    for (int n = 0; n < 100; n++) {
        someone_somewhere(&r, 3, 6);
        add_noise(&r, 5);
        run();
        const edml_placement first = placement;
        rotate_points(pose.joint, random_rotation(&r), pose.joint);
        run();
        TEST_ASSERT_ERROR_UP_TO(PLACE_AXES, worst_joint_error(placement.joint, first.joint));
        TEST_ASSERT_ERROR_UP_TO(PLACE_NOISY_PIXELS, placement.reprojection - first.reprojection);
    }
}

static void joints_that_were_not_seen_do_not_matter(void)
{
    rng r = rng_seed(77);
    someone_somewhere(&r, 3, 6);
    add_noise(&r, 5);
    in[EDML_L_WRIST].c = in[EDML_R_KNEE].c = 0;
    run();
    const edml_placement first = placement;
    in[EDML_L_WRIST].x = NAN;
    in[EDML_R_KNEE].y = -1e6F;
    run();
    TEST_ASSERT_ERROR_UP_TO(0, worst_joint_error(placement.joint, first.joint));
    TEST_ASSERT_ERROR_UP_TO(0, placement.reprojection - first.reprojection);
}

static void doubtful_joints_count_for_less(void)
{
    rng r = rng_seed(78);
    someone_somewhere(&r, 3, 6);
    in[EDML_R_ANKLE].x += 40;
    float error[3];
    for (int n = 0; n < 3; n++) {
        in[EDML_R_ANKLE].c = n == 0   ? 1
                             : n == 1 ? 0.1F
                                      : 0.005F; /* the last: a thousandth of all, or less */
        run();
        error[n] = translation_error();
    }
    TEST_ASSERT_TRUE(error[1] < error[0] / 3);
    TEST_ASSERT_ERROR_UP_TO(PLACE_RELATIVE, error[2]);
}

/* ---- Unknown focal length ---------------------------------------------------------------------- */

static void the_sweep_finds_a_focal_length_of_its_own(void)
{
    rng r = rng_seed(79);
    for (int n = 0; n < 12; n++) {
        const float focal = 480 * 0.5F * powf(8, (float)n / 11);
        edml_camera found;
        someone_somewhere(&r, 2, 2.5F);
        const edml_camera one = {focal, focal, 320, 240};
        see(in, &one, person);
        TEST_ASSERT_EQUAL_INT(
            EDML_OK, edml_place_sweep(&placement, &found, &pose, in, 640, 480, &work, sizeof work));
        TEST_ASSERT_ERROR_UP_TO(0.01F, found.fx / focal - 1);
        TEST_ASSERT_TRUE(found.fx == found.fy && found.cx == 320 && found.cy == 240);
        TEST_ASSERT_ERROR_UP_TO(PLACE_SWEEP_RELATIVE, translation_error());
    }
}

static void the_sweep_needs_an_image(void)
{
    static const float sizes[][2] = {{640, 0},   {640, -480}, {0, 480},        {-640, 480},
                                     {640, NAN}, {NAN, 480},  {INFINITY, 480}, {640, INFINITY}};
    rng r = rng_seed(80);
    edml_camera found;
    someone_somewhere(&r, 3, 6);
    for (int n = 0; n < 8; n++)
        TEST_ASSERT_EQUAL_INT(EDML_ERR_CAMERA, edml_place_sweep(&placement, &found, &pose, in, sizes[n][0],
                                                                sizes[n][1], &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT,
                          edml_place_sweep(NULL, &found, &pose, in, 640, 480, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT,
                          edml_place_sweep(&placement, NULL, &pose, in, 640, 480, &work, sizeof work));
    TEST_ASSERT_EQUAL_INT(EDML_ERR_ARGUMENT,
                          edml_place_sweep(&placement, &found, NULL, in, 640, NAN, &work, sizeof work));
}

/* ---- What gets no place ------------------------------------------------------------------------ */

/* The output is left alone. */
static void expect(edml_status status)
{
    edml_placement before;
    memset(&placement, 0x5A, sizeof placement);
    memcpy(&before, &placement, sizeof before);
    TEST_ASSERT_EQUAL_INT(status, edml_place(&placement, &pose, in, &camera, &work, sizeof work));
    TEST_ASSERT_SAME_BYTES(before, placement);
}

static void someone_usual(uint32_t seed)
{
    rng r = rng_seed(seed);
    someone_somewhere(&r, 3, 6);
}

static void what_is_no_camera(void)
{
    static const float wrong[] = {0, -1145, NAN, INFINITY, -INFINITY};
    for (int n = 0; n < 5; n++) {
        someone_usual(82);
        camera.fx = wrong[n];
        expect(EDML_ERR_CAMERA);
        someone_usual(82);
        camera.fy = wrong[n];
        expect(EDML_ERR_CAMERA);
        if (n < 2) continue;
        someone_usual(82);
        camera.cx = wrong[n];
        expect(EDML_ERR_CAMERA);
        someone_usual(82);
        camera.cy = wrong[n];
        expect(EDML_ERR_CAMERA);
    }
}

static void a_camera_that_cannot_have_seen_that(void)
{
    someone_usual(83);
    camera.fx = camera.fy = 50; /* joints 63 degrees off the axis */
    in[EDML_HEAD].y = camera.cy - 101;
    expect(EDML_ERR_CAMERA);
    someone_usual(83);
    in[EDML_HEAD].x += 2000;
    expect(EDML_ERR_CAMERA);
}

static void joints_that_are_no_numbers(void)
{
    static const float wrong[] = {NAN, INFINITY, -INFINITY};
    for (int n = 0; n < 3; n++) {
        someone_usual(84);
        in[3].x = wrong[n];
        expect(EDML_ERR_NOT_FINITE);
        someone_usual(84);
        in[3].y = wrong[n];
        expect(EDML_ERR_NOT_FINITE);
        someone_usual(84);
        pose.joint[5].z = wrong[n];
        expect(EDML_ERR_NOT_FINITE);
    }
    someone_usual(84);
    pose.joint[5].x = -4.5F;
    expect(EDML_ERR_NOT_FINITE);
}

static void too_few_joints(void)
{
    rng r = rng_seed(85);
    someone_somewhere(&r, 3, 6);
    hide(&r, 7);
    run();
    hide(&r, 1);
    expect(EDML_ERR_TOO_FEW_JOINTS);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = 0;
    expect(EDML_ERR_TOO_FEW_JOINTS);
}

static void points_and_lines(void)
{
    someone_usual(86);
    memset(pose.joint, 0, sizeof pose.joint);
    expect(EDML_ERR_DEGENERATE);
    someone_usual(86);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x = in[j].y = 500;
    expect(EDML_ERR_DEGENERATE);
    someone_usual(86);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x = 0.5F * in[j].y + 100;
    expect(EDML_ERR_DEGENERATE);
    someone_usual(86);
    for (int j = 0; j < EDML_JOINTS; j++) pose.joint[j].y = pose.joint[j].z = 0;
    expect(EDML_ERR_DEGENERATE);
}

static void people_too_far_away(void)
{
    static const float depth[] = {99, 101};
    for (int n = 0; n < 2; n++) {
        camera = usual;
        human_pose(person);
        stand_at(1, 1, depth[n]);
        take_pose(mid_hip(), turn);
        see(in, &camera, person);
        if (n == 0)
            run();
        else
            expect(EDML_ERR_CAMERA);
    }
}

/* An arm of 2.5 m, which was not seen, from someone 1.6 m away who points at the camera. */
static void a_joint_behind_the_camera(void)
{
    someone_usual(88);
    camera = usual;
    human_pose(person);
    stand_at(0, 0, 1.6F);
    see(in, &camera, person);
    in[EDML_L_WRIST].c = 0;
    take_pose(mid_hip(), turn);
    run();
    person[EDML_L_WRIST].z = -0.9F;
    take_pose(mid_hip(), turn);
    expect(EDML_ERR_CAMERA);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(exact_points_are_found_again);
    RUN_TEST(near_and_far_people_are_found_again);
    RUN_TEST(joints_are_turned_and_moved_as_it_says);
    RUN_TEST(flat_people_are_seen_where_they_were);
    RUN_TEST(no_place_nearby_is_better);
    RUN_TEST(the_axes_of_the_pose_do_not_matter);
    RUN_TEST(joints_that_were_not_seen_do_not_matter);
    RUN_TEST(doubtful_joints_count_for_less);
    RUN_TEST(the_sweep_finds_a_focal_length_of_its_own);
    RUN_TEST(the_sweep_needs_an_image);
    RUN_TEST(what_is_no_camera);
    RUN_TEST(a_camera_that_cannot_have_seen_that);
    RUN_TEST(joints_that_are_no_numbers);
    RUN_TEST(too_few_joints);
    RUN_TEST(points_and_lines);
    RUN_TEST(people_too_far_away);
    RUN_TEST(a_joint_behind_the_camera);
    return UNITY_END();
}
