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
    for (int n = 0; n < 20000; n++) {
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
    printf("camera: 20000 people without depth, %d lost\n", lost);
    TEST_ASSERT_TRUE(lost <= PLACE_FLAT_LOST);
}

/* ---- Noise ------------------------------------------------------------------------------------- */

static void add_noise_and_confidences(rng *r, float pixels)
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
        add_noise_and_confidences(&r, 5);
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
        add_noise_and_confidences(&r, 5);
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
    add_noise_and_confidences(&r, 5);
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

/* ---- The rotation ------------------------------------------------------------------------------ */

/* How far the products of its rows are from those of a rotation. */
static float rotation_defect(void)
{
    float most = 0;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j <= i; j++) {
            const edml_point a = placement.rotation[i], b = placement.rotation[j];
            const double product =
                (double)a.x * (double)b.x + (double)a.y * (double)b.y + (double)a.z * (double)b.z;
            most = worse(most, (float)fabs(product - (i == j)));
        }
    }
    return most;
}

/* Someone without depth, turned about the vertical and tilted, degrees. */
static void someone_flat(int yaw, int pitch, int distance)
{
    const double radians = 0.017453292519943295;
    const double cy = cos(yaw * radians), sy = sin(yaw * radians);
    const double cp = cos(pitch * radians), sp = sin(pitch * radians);
    const rotation3 about = {{{cy, 0, sy}, {sp * sy, cp, -sp * cy}, {-cp * sy, sp, cp * cy}}};
    camera = usual;
    human_pose(person);
    for (int j = 0; j < EDML_JOINTS; j++) person[j].z = 0;
    take_pose(mid_hip(), turn);
    rotate_points(person, about, person);
    stand_at(0, 0, (float)distance);
    see(in, &camera, person);
}

/* Where many short steps are needed. */
static void a_rotation_of_a_flat_person_is_one(void)
{
    rng r = rng_seed(94);
    float worst = 0;
    int placed = 0;
    for (int yaw = -80; yaw <= 80; yaw += 10) {
        for (int pitch = -80; pitch <= 80; pitch += 5) {
            for (int distance = 5; distance <= 40; distance += 5) {
                turn = random_rotation(&r);
                someone_flat(yaw, pitch, distance);
                if (pitch % 10 == 0) add_noise_and_confidences(&r, 1);
                if (edml_place(&placement, &pose, in, &camera, &work, sizeof work) != EDML_OK) continue;
                placed++;
                worst = worse(worst, rotation_defect());
            }
        }
    }
    printf("camera: rotations of %d flat people, off by %.1e at most\n", placed, (double)worst);
    TEST_ASSERT_TRUE(placed > 1000);
    TEST_ASSERT_ERROR_UP_TO(PLACE_ROTATION, worst);
}

#ifndef EDML_TEST_Q24
/* Whatever a pixel is: in a thousandth of a nanometre or in light years. */
static void the_unit_of_the_image_does_not_matter(void)
{
    rng r = rng_seed(96);
    for (int exponent = -115; exponent <= 115; exponent += 10) {
        edml_camera other;
        edml_placement expected, found;
        someone_somewhere(&r, 3, 6);
        add_noise_and_confidences(&r, 5);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_place(&expected, &pose, in, &camera, &work, sizeof work));
        const edml_camera scaled = {ldexpf(camera.fx, exponent), ldexpf(camera.fy, exponent),
                                    ldexpf(camera.cx, exponent), ldexpf(camera.cy, exponent)};
        for (int j = 0; j < EDML_JOINTS; j++) {
            in[j].x = ldexpf(in[j].x, exponent);
            in[j].y = ldexpf(in[j].y, exponent);
        }
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_place(&found, &pose, in, &scaled, &work, sizeof work));
        found.reprojection = ldexpf(found.reprojection, -exponent);
        TEST_ASSERT_EQUAL_MEMORY(&expected, &found, offsetof(edml_placement, steps)); /* no padding */
        const float height = ldexpf(2 * camera.cy, exponent);
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_place_sweep(&found, &other, &pose, in, 2 * scaled.cx, height,
                                                        &work, sizeof work));
        TEST_ASSERT_TRUE(found.reprojection > 0 && found.reprojection < height);
    }
}
#endif

static void a_rotation_of_anybody_is_one(void)
{
    rng r = rng_seed(95);
    float worst = 0;
    for (int n = 0; n < 3000; n++) {
        someone_somewhere(&r, n % 2 ? 1.6F : 8, n % 2 ? 6 : 80);
        if (n % 3 == 0) add_noise_and_confidences(&r, uniform(&r, 1, 30));
        if (n % 5 == 0) random_points(&r, pose.joint, uniform(&r, 0.1F, 4));
        if (edml_place(&placement, &pose, in, &camera, &work, sizeof work) != EDML_OK) continue;
        worst = worse(worst, rotation_defect());
    }
    TEST_ASSERT_ERROR_UP_TO(PLACE_ROTATION, worst);
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
    rng r = rng_seed(90);
    for (int n = 0; n < 2; n++) {
        camera = usual;
        human_pose(person);
        stand_at(1, 1, depth[n]);
        take_pose(mid_hip(), random_rotation(&r));
        see(in, &camera, person);
        if (n == 0)
            run();
        else
            expect(EDML_ERR_CAMERA);
    }
}

/* A foot so far to the side, of somebody at 1.5 m, with a confidence that leaves the mean ray where it is. */
static void see_a_foot_aside(rng *r, float degrees)
{
    camera = usual;
    human_pose(person);
    root_at_mid_hip(person);
    stand_at(0, 0, 1.5F);
    person[EDML_L_ANKLE].x = 1.5F * tanf(degrees * 0.01745329F);
    person[EDML_L_ANKLE].y = 0;
    person[EDML_L_ANKLE].z = 1.5F;
    take_pose(mid_hip(), random_rotation(r));
    see(in, &camera, person);
    in[EDML_L_ANKLE].c = 0.02F;
}

static void a_joint_over_60_degrees_off_the_others_was_not_seen(void)
{
    rng r = rng_seed(301);
    for (int n = 0; n < 10; n++) {
        see_a_foot_aside(&r, 57);
        run();
        see_a_foot_aside(&r, 62.5F);
        expect(EDML_ERR_CAMERA);
    }
}

/* What work memory holds from before does not take the place of a ray that there cannot be. */
static void a_ray_too_far_off_the_axis_is_refused_whatever_was_before(void)
{
    rng r = rng_seed(302);
    for (int j = 0; j < EDML_JOINTS; j++) {
        someone_somewhere(&r, 3, 6);
        run();
        in[j].x = camera.cx + 2.01F * camera.fx;
        expect(EDML_ERR_CAMERA);
        in[j].x = camera.cx;
        in[j].y = camera.cy - 2.01F * camera.fy;
        expect(EDML_ERR_CAMERA);
    }
}

static void what_work_memory_holds_before_does_not_matter(void)
{
    rng r = rng_seed(303);
    for (int n = 0; n < 20; n++) {
        someone_somewhere(&r, 3, 6);
        hide(&r, n % 8);
        memset(&work, 0, sizeof work);
        run();
        const edml_placement first = placement;
        memset(&work, 0xFF, sizeof work); /* NaN, in float */
        run();
        TEST_ASSERT_SAME_BYTES(first, placement);
    }
}

/* A wrist stretched towards the camera until nothing but a third of the person's distance is left, and less. */
static void a_joint_within_a_third_of_the_distance_was_not_seen(void)
{
    static const float depth[] = {0.45F, 0.25F};
    rng r = rng_seed(304);
    for (int n = 0; n < 2; n++) {
        camera = usual;
        human_pose(person);
        root_at_mid_hip(person);
        stand_at(0, 0, 1.2F);
        person[EDML_L_WRIST] = (edml_point){0.05F, 0, depth[n]};
        take_pose(mid_hip(), random_rotation(&r));
        see(in, &camera, person);
        if (n == 0)
            run();
        else
            expect(EDML_ERR_CAMERA);
    }
}

/* Points nearly on a line, and unrelated keypoints of any confidence. */
static void see_nonsense(uint32_t seed)
{
    rng r = rng_seed(seed);
    const float size = uniform(&r, 0, 3.9F), tangent = uniform(&r, 0, 1.9F);
    camera = (edml_camera){1000, 1000, 500, 500};
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose.joint[j].x = uniform(&r, -size, size);
        pose.joint[j].y = 0.02F * uniform(&r, -size, size);
        pose.joint[j].z = 0.02F * uniform(&r, -size, size);
        in[j].x = 500 + 1000 * uniform(&r, -tangent, tangent);
        in[j].y = 500 + 1000 * uniform(&r, -tangent, tangent);
        in[j].c = expf(uniform(&r, -7, 0));
    }
}

/* Among them some that neither start brings before the camera, some whose equations have no solution, and some
 * with joints far aside of where the camera looks. */
static void nonsense_is_placed_before_the_camera_or_refused(void)
{
    static const uint32_t worst[] = {7836, 1123, 4154};
    for (uint32_t n = 0; n < 303; n++) {
        see_nonsense(n < 300 ? n : worst[n - 300]);
        const edml_status status = edml_place(&placement, &pose, in, &camera, &work, sizeof work);
        if (status != EDML_OK) {
            expect(status);
            continue;
        }
        TEST_ASSERT_TRUE(placement.reprojection >= 0);
        for (int j = 0; j < EDML_JOINTS; j++) TEST_ASSERT_TRUE(placement.joint[j].z > 0);
    }
}

/* A thousandth of all confidence, just, is too little to count; then six joints are left. */
static void a_joint_with_a_thousandth_of_the_confidence_does_not_count(void)
{
    someone_usual(87);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = j < 6 ? 170.5F / 1024 : j == 6 ? 1.0F / 1024 : 0;
    expect(EDML_ERR_TOO_FEW_JOINTS);
    in[6].c = 2.0F / 1024;
    run();
}

#ifndef EDML_TEST_Q24 /* there sums of confidences fit */
static void confidences_whose_sum_is_no_number_are_refused(void)
{
    someone_usual(89);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = 1e38F;
    expect(EDML_ERR_NOT_FINITE);
}
#endif

/* In fixed point the longer half of the focal lengths is out of range there. */
static void an_image_of_twelve_megapixels_has_a_focal_length(void)
{
    rng r = rng_seed(305);
    for (int n = 0; n < 10; n++) {
        edml_camera found;
        camera = (edml_camera){1932, 1932, 2000, 1500}; /* one of the sweep's */
        random_human(&r, person);
        root_at_mid_hip(person);
        stand_at(0.3F, 0, 1.8F);
        take_pose(mid_hip(), random_rotation(&r));
        see(in, &camera, person);
        TEST_ASSERT_EQUAL_INT(EDML_OK,
                              edml_place_sweep(&placement, &found, &pose, in, 4000, 3000, &work, sizeof work));
        TEST_ASSERT_FLOAT_WITHIN(0.35F * 1932, 1932, found.fx);
        TEST_ASSERT_TRUE(found.cx == 2000 && found.cy == 1500);
    }
}

/* Three quarters of the largest number high: half of the focal lengths are beyond it. */
static void an_image_as_large_as_numbers_get_has_a_focal_length(void)
{
#ifdef EDML_TEST_Q24
    const float unit = 1;
#else
    const float unit = 4e34F;
#endif
    edml_camera found;
    camera = (edml_camera){5289, 5289, 3000, 3000}; /* one of the sweep's */
    human_pose(person);
    root_at_mid_hip(person);
    stand_at(0.1F, 0, 2);
    take_pose(mid_hip(), (rotation3){{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}});
    see(in, &camera, person);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x *= unit;
        in[j].y *= unit;
    }
    TEST_ASSERT_EQUAL_INT(EDML_OK, edml_place_sweep(&placement, &found, &pose, in, 6000 * unit, 6000 * unit,
                                                    &work, sizeof work));
    TEST_ASSERT_FLOAT_WITHIN(0.35F * 5289, 5289, found.fx / unit);
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

/* ---- Lifts with a camera ------------------------------------------------------------------------- */

static const edml_model *const lifters[] = {&edml_direct_f32, &edml_distances_f32, &edml_fconn_f32};
static edml_pose lifted, on_axis;

static edml_status lift(edml_pose *out, const edml_point *up, const edml_model *model)
{
    return edml_lift_with_camera(out, in, up, &camera, model, &work, sizeof work);
}

/* The smallest rotation that brings the mean line of sight of the seen joints onto the axis. */
static rotation3 view_of_person(void)
{
    double mean[3] = {0, 0, 0};
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(in[j].c > 0)) continue;
        mean[0] += ((double)in[j].x - (double)camera.cx) / (double)camera.fx;
        mean[1] += ((double)in[j].y - (double)camera.cy) / (double)camera.fy;
        mean[2] += 1;
    }
    const double size = sqrt(mean[0] * mean[0] + mean[1] * mean[1] + mean[2] * mean[2]);
    const double x = mean[0] / size, y = mean[1] / size, z = mean[2] / size, k = 1 / (1 + z);
    const rotation3 view = {{{1 - k * x * x, -k * x * y, -x}, {-k * x * y, 1 - k * y * y, -y}, {x, y, z}}};
    return view;
}

static rotation3 inverse(rotation3 r)
{
    rotation3 out;
    for (int n = 0; n < 9; n++) out.at[n / 3][n % 3] = r.at[n % 3][n / 3];
    return out;
}

static edml_point rotated(rotation3 by, edml_point p)
{
    edml_point all[EDML_JOINTS];
    equal_points(all, p.x, p.y, p.z);
    rotate_points(all, by, all);
    return all[0];
}

/* Someone before the camera, off its axis by up to 45 degrees. */
static void someone_off_axis(rng *r)
{
    camera = usual;
    camera.fy *= uniform(r, 0.8F, 1.25F);
    random_human(r, person);
    const float depth = uniform(r, 3, 8);
    stand_at(depth * uniform(r, -0.8F, 0.8F), depth * uniform(r, -0.4F, 0.4F), depth);
    see(in, &camera, person);
}

/* A camera at the same place that looks at the person sees them on its axis: the same pose but for the turn. */
static void a_person_off_the_axis_is_the_one_on_the_axis_turned(void)
{
    rng r = rng_seed(91);
    float worst = 0, moved = 0;
    for (int n = 0; n < 150; n++) {
        const edml_model *const model = lifters[n % 3];
        const edml_point up = {gauss(&r), gauss(&r) - 1, gauss(&r)};
        someone_off_axis(&r);
        if (n % 5 == 0) in[EDML_R_WRIST].c = in[EDML_L_KNEE].c = 0;
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift(&lifted, n % 4 ? &up : NULL, model));
        const rotation3 view = view_of_person();
        const edml_camera wanted = camera, level = {1500, 1500, 320, 240};
        edml_keypoint given[EDML_JOINTS];
        memcpy(given, in, sizeof given);
        edml_point turned[EDML_JOINTS];
        rotate_points(turned, view, person);
        see(in, &level, turned);
        for (int j = 0; j < EDML_JOINTS; j++) in[j].c = given[j].c;
        const edml_point turned_up = rotated(view, up);
        TEST_ASSERT_EQUAL_INT(
            EDML_OK, edml_lift(&on_axis, in, n % 4 ? &turned_up : NULL, model, &work, sizeof work));
        moved = worse(moved, worst_joint_error(lifted.joint, on_axis.joint));
        rotate_points(on_axis.joint, inverse(view), on_axis.joint);
        if (model == &edml_fconn_f32 && worst_joint_error(lifted.joint, on_axis.joint) > 0.1F)
            continue; /* the mirror image, where rounding decides */
        worst = worse(worst, worst_joint_error(lifted.joint, on_axis.joint));
        worst = worse(worst, fabsf(lifted.misfit - on_axis.misfit));
        TEST_ASSERT_EQUAL_INT(on_axis.seen, lifted.seen);
        camera = wanted;
    }
    printf("camera: lifted off the axis and on it, worst joint %.3f mm\n", 1e3 * (double)worst);
    TEST_ASSERT_ERROR_UP_TO(LIFT_OFF_AXIS_TOLERANCE, worst);
    TEST_ASSERT_TRUE(moved > 0.1F);
}

/* On the axis there is nothing to turn. */
static void on_the_axis_it_is_the_lift_without_a_camera(void)
{
    rng r = rng_seed(92);
    for (int n = 0; n < 60; n++) {
        const edml_model *const model = lifters[n % 2];
        camera = usual;
        random_human(&r, person);
        stand_at(0, 0, 5);
        see(in, &camera, person);
        double x = 0, y = 0;
        for (int j = 0; j < EDML_JOINTS; j++) {
            x += (double)in[j].x / EDML_JOINTS;
            y += (double)in[j].y / EDML_JOINTS;
        }
        camera.cx = (float)x;
        camera.cy = (float)y;
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift(&lifted, NULL, model));
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift(&on_axis, in, NULL, model, &work, sizeof work));
        TEST_ASSERT_ERROR_UP_TO(LIFT_OFF_AXIS_TOLERANCE, worst_joint_error(lifted.joint, on_axis.joint));
        const edml_point a = lifted.joint[EDML_R_HIP], b = lifted.joint[EDML_L_HIP];
        TEST_ASSERT_ERROR_UP_TO(LIFT_ROUNDING, fabsf(a.x + b.x) + fabsf(a.y + b.y) + fabsf(a.z + b.z));
    }
}

/* The output is left alone. */
static void expect_no_lift(edml_status status, const edml_point *up)
{
    for (int m = 0; m < 3; m++) {
        memset(&lifted, 0x5A, sizeof lifted);
        memcpy(&on_axis, &lifted, sizeof on_axis);
        TEST_ASSERT_EQUAL_INT(status, lift(&lifted, up, lifters[m]));
        TEST_ASSERT_SAME_BYTES(on_axis, lifted);
    }
}

static void a_lift_needs_a_camera_that_can_have_seen_this(void)
{
    static const float wrong[] = {0, -1145, NAN, INFINITY, -INFINITY};
    for (int n = 0; n < 5; n++) {
        someone_usual(93);
        camera.fx = wrong[n];
        expect_no_lift(EDML_ERR_CAMERA, NULL);
        someone_usual(93);
        camera.fy = wrong[n];
        expect_no_lift(EDML_ERR_CAMERA, NULL);
        if (n < 2) continue;
        someone_usual(93);
        camera.cx = wrong[n];
        expect_no_lift(EDML_ERR_CAMERA, NULL);
        someone_usual(93);
        camera.cy = wrong[n];
        expect_no_lift(EDML_ERR_CAMERA, NULL);
    }
    someone_usual(93);
    camera.fx = camera.fy = 50; /* a joint 63 degrees off the axis */
    in[EDML_HEAD].y = camera.cy - 101;
    expect_no_lift(EDML_ERR_CAMERA, NULL);
    someone_usual(93); /* others on one side, a joint 63 degrees off on the other: 60 off the person */
    camera = usual;
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x = 500 + 1145 * 1.9F - (float)j;
    in[EDML_HEAD].x = 500 - 1145 * 1.9F;
    expect_no_lift(EDML_ERR_CAMERA, NULL);
}

static void a_lift_with_a_camera_refuses_what_a_lift_refuses(void)
{
    const edml_point zero = {0, 0, 0}, bad = {0, NAN, 1};
    someone_usual(94);
    expect_no_lift(EDML_ERR_DEGENERATE, &zero);
    expect_no_lift(EDML_ERR_NOT_FINITE, &bad);
    in[3].y = NAN;
    expect_no_lift(EDML_ERR_NOT_FINITE, NULL);
    someone_usual(94);
    for (int j = 0; j < 5; j++) in[j].c = 0;
    expect_no_lift(EDML_ERR_TOO_FEW_JOINTS, NULL);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].c = 0;
    expect_no_lift(EDML_ERR_TOO_FEW_JOINTS, NULL);
    someone_usual(94);
    for (int j = 0; j < EDML_JOINTS; j++) in[j].x = in[j].y = 500;
    expect_no_lift(EDML_ERR_DEGENERATE, NULL);
    someone_usual(94);
    in[EDML_L_WRIST].c = 0; /* is not looked at */
    in[EDML_L_WRIST].x = NAN;
    TEST_ASSERT_EQUAL_INT(EDML_OK, lift(&lifted, NULL, lifters[0]));
}

#ifndef EDML_TEST_Q24
static void in_fixed_point_it_is_nearly_the_same(void)
{
    static edml_work_q work_q;
    static const edml_model *const integers[] = {&edml_direct_w16, &edml_distances_w16, &edml_direct_w8};
    rng r = rng_seed(95);
    float worst = 0;
    for (int n = 0; n < 150; n++) {
        const edml_model *const model = integers[n % 3];
        const edml_point up = {gauss(&r), gauss(&r) - 1, gauss(&r)};
        edml_keypoint_q in_q[EDML_JOINTS];
        edml_pose_q whole;
        someone_off_axis(&r);
        if (n % 5 == 0) in[EDML_R_WRIST].c = in[EDML_L_KNEE].c = 0;
        to_q16(in_q, in);
        const edml_camera_q by = camera_to_q16(camera);
        const edml_point_q up_q = point_to_q16(up);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift(&lifted, n % 4 ? &up : NULL, model));
        TEST_ASSERT_EQUAL_INT(EDML_OK, edml_lift_with_camera_q(&whole, in_q, n % 4 ? &up_q : NULL, &by,
                                                               model, &work_q, sizeof work_q));
        for (int j = 0; j < EDML_JOINTS; j++) {
            const edml_point p = {(float)(whole.joint[j].x / 65536.0), (float)(whole.joint[j].y / 65536.0),
                                  (float)(whole.joint[j].z / 65536.0)};
            on_axis.joint[j] = p;
        }
        worst = worse(worst, worst_joint_error(lifted.joint, on_axis.joint));
        TEST_ASSERT_EQUAL_INT(lifted.seen, whole.seen);
    }
    printf("camera: lifts in fixed point beside float, worst joint %.3f mm\n", 1e3 * (double)worst);
    TEST_ASSERT_ERROR_UP_TO(FIXED_LIFT_TOLERANCE, worst);
}
#endif

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(exact_points_are_found_again);
    RUN_TEST(near_and_far_people_are_found_again);
    RUN_TEST(joints_are_turned_and_moved_as_it_says);
    RUN_TEST(flat_people_are_seen_where_they_were);
    RUN_TEST(no_place_nearby_is_better);
    RUN_TEST(a_rotation_of_a_flat_person_is_one);
    RUN_TEST(a_rotation_of_anybody_is_one);
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
    RUN_TEST(a_joint_over_60_degrees_off_the_others_was_not_seen);
    RUN_TEST(a_ray_too_far_off_the_axis_is_refused_whatever_was_before);
    RUN_TEST(what_work_memory_holds_before_does_not_matter);
    RUN_TEST(a_joint_within_a_third_of_the_distance_was_not_seen);
    RUN_TEST(nonsense_is_placed_before_the_camera_or_refused);
    RUN_TEST(a_joint_with_a_thousandth_of_the_confidence_does_not_count);
#ifndef EDML_TEST_Q24
    RUN_TEST(confidences_whose_sum_is_no_number_are_refused);
#endif
    RUN_TEST(an_image_of_twelve_megapixels_has_a_focal_length);
    RUN_TEST(an_image_as_large_as_numbers_get_has_a_focal_length);
    RUN_TEST(a_joint_behind_the_camera);
    RUN_TEST(a_person_off_the_axis_is_the_one_on_the_axis_turned);
    RUN_TEST(on_the_axis_it_is_the_lift_without_a_camera);
    RUN_TEST(a_lift_needs_a_camera_that_can_have_seen_this);
    RUN_TEST(a_lift_with_a_camera_refuses_what_a_lift_refuses);
#ifndef EDML_TEST_Q24
    RUN_TEST(the_unit_of_the_image_does_not_matter);
    RUN_TEST(in_fixed_point_it_is_nearly_the_same);
#endif
    return UNITY_END();
}
