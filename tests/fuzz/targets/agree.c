/* Float and fixed point give nearly the same: of numbers that both have exactly, and as far as a little rounding
 * changes the float one little.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS agree
#include <stdlib.h>

#include "../native.h"

#include "edmlift/fixed.h"

static edml_work work;
static edml_work_q work_q;

/* ---- Inputs of both ------------------------------------------------------------------------------- */

static int32_t q16(float a) { return (int32_t)lrintf(a * 65536); }

/* To a 256th of a pixel, within the range of both. */
static void draw_both(edml_keypoint in[EDML_JOINTS], edml_keypoint_q in_q[EDML_JOINTS], choices *from)
{
    sighting frame[EDML_JOINTS];
    draw_frame(frame, from);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = rintf(256 * (float)fmax(-8000, fmin(8000, frame[j].x))) / 256;
        in[j].y = rintf(256 * (float)fmax(-8000, fmin(8000, frame[j].y))) / 256;
        in[j].c = frame[j].c > 0 ? 1 : 0;
        in_q[j].x = q16(in[j].x);
        in_q[j].y = q16(in[j].y);
        in_q[j].c = in[j].c > 0 ? 32767 : 0;
    }
}

static void draw_both_poses(edml_pose *pose, edml_pose_q *pose_q, choices *from)
{
    place3 x[EDML_JOINTS];
    draw_pose(x, from);
    to_pose(pose, x, from);
    for (int j = 0; j < EDML_JOINTS; j++) {
        float *const a = &pose->joint[j].x;
        int32_t *const b = &pose_q->joint[j].x;
        for (int n = 0; n < 3; n++) {
            b[n] = q16(fmaxf(-3.9999F, fminf(3.9999F, a[n])));
            a[n] = (float)b[n] / 65536;
        }
    }
    pose->misfit = (float)draw_between(from, 0, 0.2);
    pose_q->misfit = q16(pose->misfit);
    pose_q->seen = pose->seen;
}

static place3 from_q(edml_point_q p)
{
    const place3 place = {p.x / 65536.0, p.y / 65536.0, p.z / 65536.0};
    return place;
}

static double worst_of(const edml_point a[EDML_JOINTS], const edml_point_q b[EDML_JOINTS])
{
    double worst = 0;
    for (int j = 0; j < EDML_JOINTS; j++) worst = fmax(worst, distance_of(from_point(a[j]), from_q(b[j])));
    return worst;
}

/* ---- Lifts ---------------------------------------------------------------------------------------- */

/* Where the two may differ: at a border of what is degenerate, of which fixed point has one more. */
static int is_border(edml_status a, edml_status b)
{
    return a != b && (a == EDML_ERR_DEGENERATE || b == EDML_ERR_DEGENERATE);
}

static double frame_difference(const edml_keypoint in[EDML_JOINTS], const edml_keypoint_q in_q[EDML_JOINTS])
{
    edml_image image;
    edml_image_q image_q;
    double worst = 0;
    if (edml_body_frame(&image, in, 10, &edml_default_imputation) != EDML_OK ||
        edml_body_frame_q(&image_q, in_q, 10, &edml_default_imputation) != EDML_OK)
        return INFINITY;
    for (int j = 0; j < EDML_JOINTS; j++)
        worst = fmax(worst, hypot((double)image.at[j].u - image_q.at[j].u / 16777216.0,
                                  (double)image.at[j].v - image_q.at[j].v / 16777216.0));
    return worst;
}

/* Where the body has an axis, and is one: else the network's points and the image are too unlike, and at one
 * border they are or are not fused (lib/lift/fuse.h). */
static void lift_both(choices *from)
{
    edml_keypoint in[EDML_JOINTS];
    edml_keypoint_q in_q[EDML_JOINTS];
    edml_pose pose;
    edml_pose_q pose_q;
    draw_both(in, in_q, from);
    const edml_status status = edml_lift(&pose, in, NULL, &edml_direct_w16, &work, sizeof work);
    const edml_status status_q = edml_lift_q(&pose_q, in_q, NULL, &edml_direct_w16, &work_q, sizeof work_q);
    if (is_border(status, status_q)) return;
    REQUIRE(status == status_q, "a lift has two statuses");
    if (status != EDML_OK) return;
    REQUIRE(pose.seen == pose_q.seen, "a lift has two seen masks");
    if (pose.misfit > 0.2F || frame_difference(in, in_q) > 1e-4) return;
    REQUIRE(fabs((double)pose.misfit - pose_q.misfit / 65536.0) <= 0.01, "a lift has two misfits");
    REQUIRE(worst_of(pose.joint, pose_q.joint) <= 0.02, "a lift has two poses");
}

static void adapt_both(choices *from)
{
    edml_keypoint in[2 * EDML_JOINTS], out[EDML_JOINTS];
    edml_keypoint_q in_q[2 * EDML_JOINTS], out_q[EDML_JOINTS];
    draw_both(in, in_q, from);
    draw_both(in + EDML_JOINTS, in_q + EDML_JOINTS, from);
    const edml_format *const format = draw_one_in(from, 2) ? &edml_body25 : &edml_coco17;
    edml_adapt(out, in, format);
    edml_adapt_q(out_q, in_q, format);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double x = (double)out[j].x - out_q[j].x / 65536.0,
                     y = (double)out[j].y - out_q[j].y / 65536.0;
        REQUIRE(fabs(x) <= 2e-3 && fabs(y) <= 2e-3, "a joint has two places");
        REQUIRE((out[j].c > 0) == (out_q[j].c > 0), "a joint is seen and not seen");
    }
}

/* ---- Placements ----------------------------------------------------------------------------------- */

/* Have the points three dimensions?  The determinant of their scatter is 1 where all are alike. */
static int are_thick(const place3 x[EDML_JOINTS])
{
    double s[6] = {0}, mean[3] = {0};
    for (int j = 0; j < EDML_JOINTS; j++) {
        mean[0] += x[j].x / EDML_JOINTS;
        mean[1] += x[j].y / EDML_JOINTS;
        mean[2] += x[j].z / EDML_JOINTS;
    }
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double a = x[j].x - mean[0], b = x[j].y - mean[1], c = x[j].z - mean[2];
        s[0] += a * a;
        s[1] += b * b;
        s[2] += c * c;
        s[3] += b * c;
        s[4] += a * c;
        s[5] += a * b;
    }
    const double third = (s[0] + s[1] + s[2]) / 3, determinant = s[0] * (s[1] * s[2] - s[3] * s[3]) -
                                                                 s[5] * (s[5] * s[2] - s[3] * s[4]) +
                                                                 s[4] * (s[5] * s[3] - s[1] * s[4]);
    return third > 0.1 && determinant > 0.1 * third * third * third;
}

/* People who are not flat, before a usual camera, exactly: there is one best placement. */
static void place_both(choices *from)
{
    const float focal = (float)draw_magnitude(from, 500, 2000);
    const place3 far = {draw_between(from, -1, 1), draw_between(from, -1, 1), draw_between(from, 3, 8)};
    const pinhole by = {(double)rintf(focal), (double)rintf(focal), 960, 540};
    const edml_camera camera = {rintf(focal), rintf(focal), 960, 540};
    const edml_camera_q camera_q = {q16(camera.fx), q16(camera.fy), q16(960), q16(540)};
    place3 x[EDML_JOINTS];
    edml_keypoint in[EDML_JOINTS];
    edml_keypoint_q in_q[EDML_JOINTS];
    edml_pose pose;
    edml_pose_q pose_q;
    edml_placement placement;
    edml_placement_q placement_q;
    draw_both_poses(&pose, &pose_q, from);
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j] = from_point(pose.joint[j]);
        const double z = x[j].z + far.z;
        if (!(z > 1)) return;
        in[j].x = rintf(256 * (float)(by.fx * (x[j].x + far.x) / z + by.cx)) / 256;
        in[j].y = rintf(256 * (float)(by.fy * (x[j].y + far.y) / z + by.cy)) / 256;
        if (!(fabsf(in[j].x) < 8000 && fabsf(in[j].y) < 8000)) return;
        in[j].c = 1;
        in_q[j].x = q16(in[j].x);
        in_q[j].y = q16(in[j].y);
        in_q[j].c = 32767;
    }
    const edml_status status = edml_place(&placement, &pose, in, &camera, &work, sizeof work);
    const edml_status status_q = edml_place_q(&placement_q, &pose_q, in_q, &camera_q, &work_q,
                                              sizeof work_q);
    if (status != EDML_OK || status_q != EDML_OK || !are_thick(x)) return;
    const double error = fabs((double)placement.reprojection - placement_q.reprojection / 65536.0);
    REQUIRE(error <= 0.1, "a placement has two errors in the image");
}

/* ---- Poses ---------------------------------------------------------------------------------------- */

static void stand_both(const edml_pose *pose, const edml_pose_q *pose_q, choices *from)
{
    edml_point out[EDML_JOINTS];
    edml_point_q out_q[EDML_JOINTS];
    place3 p;
    draw_up(&p, from);
    const edml_point_q up_q = {q16((float)fmod(p.x, 4096)), q16((float)fmod(p.y, 4096)),
                               q16((float)fmod(p.z, 4096))};
    const edml_point up = {(float)up_q.x / 65536, (float)up_q.y / 65536, (float)up_q.z / 65536};
    const edml_status status = edml_stand(out, pose, up);
    REQUIRE(edml_stand_q(out_q, pose_q, up_q) == status, "standing has two statuses");
    REQUIRE(status != EDML_OK || worst_of(out, out_q) <= 1e-4, "a pose stands in two ways");
}

static void fit_both(edml_pose pose, edml_pose_q pose_q, choices *from)
{
    edml_body body;
    edml_body_q body_q;
    memset(&body, 0, sizeof body);
    memset(&body_q, 0, sizeof body_q);
    body_q.height = q16((float)draw_between(from, 0.6, 2.4));
    body.height = (float)body_q.height / 65536;
    const edml_status status = edml_fit_body(&pose, &body);
    if (edml_fit_body_q(&pose_q, &body_q) != status) return; /* at the border of what is too small */
    REQUIRE(status != EDML_OK || worst_of(pose.joint, pose_q.joint) <= 1e-4, "a body fits in two ways");
}

static void measure_both(const edml_pose *pose, const edml_pose_q *pose_q)
{
    edml_measured_body measured;
    edml_measured_body_q measured_q;
    edml_measure_start(&measured);
    edml_measure_start_q(&measured_q);
    const edml_status status = edml_measure_body(&measured, pose);
    if (edml_measure_body_q(&measured_q, pose_q) != status || status != EDML_OK) return;
    for (int n = 0; n < EDML_BONES; n++)
        REQUIRE(fabs((double)measured.body.bone[n] - measured_q.body.bone[n] / 65536.0) <= 1e-4,
                "a bone has two lengths");
}

/* The angles are the same, where both have them: one that is none is at a border. */
static void measure_angles_of_both(const edml_pose *pose, const edml_pose_q *pose_q)
{
    float degrees[EDML_ANGLES];
    int32_t degrees_q[EDML_ANGLES];
    REQUIRE(edml_angles(degrees, pose, NULL) == EDML_OK &&
                edml_angles_q(degrees_q, pose_q, NULL) == EDML_OK,
            "a pose has no angles");
    for (int n = 0; n < EDML_ANGLES; n++) {
        if (isnan(degrees[n]) || degrees_q[n] == EDML_NO_ANGLE) continue;
        REQUIRE(fabs(remainder((double)degrees[n] - degrees_q[n] / 65536.0, 360)) <= 0.1,
                edml_angle_name(n));
    }
}

static void judge_both(const edml_pose *pose, const edml_pose_q *pose_q)
{
    float quality;
    int32_t quality_q;
    const edml_status status = edml_quality(&quality, pose);
    REQUIRE(edml_quality_q(&quality_q, pose_q) == status, "quality has two statuses");
    if (status == EDML_OK)
        REQUIRE(fabs((double)quality - quality_q / 65536.0) <= 1e-3, "a pose has two qualities");
}

/* Has the torso a front, by shoulders or hips that are not along the trunk? */
static int has_front(const edml_pose *pose, int right, int left)
{
    const place3 a = from_point(pose->joint[right]), b = from_point(pose->joint[left]),
                 r = from_point(pose->joint[EDML_R_HIP]), l = from_point(pose->joint[EDML_L_HIP]),
                 n = from_point(pose->joint[EDML_NECK_BASE]);
    const place3 s = {b.x - a.x, b.y - a.y, b.z - a.z};
    const place3 u = {n.x - (r.x + l.x) / 2, n.y - (r.y + l.y) / 2, n.z - (r.z + l.z) / 2};
    const double across = hypot(hypot(s.y * u.z - s.z * u.y, s.z * u.x - s.x * u.z), s.x * u.y - s.y * u.x);
    return across > 0.01 * sqrt((s.x * s.x + s.y * s.y + s.z * s.z) * (u.x * u.x + u.y * u.y + u.z * u.z));
}

/* Bones are in the same cells, unless a rounding puts one into another; or one that is where four cells meet. */
static void count_violations_of_both(const edml_pose *pose, const edml_pose_q *pose_q, choices *from)
{
    edml_pose near = *pose;
    int count, count_q, other;
    REQUIRE(edml_joint_limits(&count, pose) == EDML_OK && edml_joint_limits_q(&count_q, pose_q) == EDML_OK,
            "joint limits refuse a pose");
    if (!has_front(pose, EDML_R_SHOULDER, EDML_L_SHOULDER) || !has_front(pose, EDML_R_HIP, EDML_L_HIP))
        return;
    for (int tries = 0; tries < 16 && count != count_q; tries++) {
        for (int j = 0; j < EDML_JOINTS; j++) {
            near.joint[j].x = pose->joint[j].x + (float)draw_between(from, -3e-5, 3e-5);
            near.joint[j].y = pose->joint[j].y + (float)draw_between(from, -3e-5, 3e-5);
            near.joint[j].z = pose->joint[j].z + (float)draw_between(from, -3e-5, 3e-5);
        }
        if (edml_joint_limits(&other, &near) != EDML_OK || other != count) return;
    }
    REQUIRE(abs(count - count_q) <= 1, "a pose has two numbers of violations");
}

void fuzz_agree(choices *from)
{
    edml_pose pose;
    edml_pose_q pose_q;
    draw_both_poses(&pose, &pose_q, from);
    stand_both(&pose, &pose_q, from);
    fit_both(pose, pose_q, from);
    measure_both(&pose, &pose_q);
    measure_angles_of_both(&pose, &pose_q);
    judge_both(&pose, &pose_q);
    count_violations_of_both(&pose, &pose_q, from);
    lift_both(from);
    adapt_both(from);
    place_both(from);
}
