/* SPDX-License-Identifier: MIT */
#include "q24.h"

#include <math.h>
#include <string.h>

#define ONE 16777216.0 /* of Q24 */

static int32_t saturate(double value, double low, double high)
{
    if (!(value > low)) return (int32_t)low; /* NaN too */
    return value < high ? (int32_t)floor(value + 0.5) : (int32_t)high;
}

static int32_t q24(float value) { return saturate(ONE * (double)value, INT32_MIN, INT32_MAX); }

static float to_float(int32_t value) { return (float)(value / ONE); }

static void all_q24(int32_t *out, const float *values, int count)
{
    for (int n = 0; n < count; n++) out[n] = q24(values[n]);
}

static void all_floats(float *out, const int32_t *values, int count)
{
    for (int n = 0; n < count; n++) out[n] = to_float(values[n]);
}

void to_q16(edml_keypoint_q out[EDML_JOINTS], const edml_keypoint in[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j].x = saturate(65536.0 * (double)in[j].x, INT32_MIN, INT32_MAX);
        out[j].y = saturate(65536.0 * (double)in[j].y, INT32_MIN, INT32_MAX);
        out[j].c = (int16_t)saturate(32768.0 * (double)in[j].c, INT16_MIN, INT16_MAX);
    }
}

static int32_t q16(float value) { return saturate(65536.0 * (double)value, INT32_MIN, INT32_MAX); }

static float from_q16(int32_t value) { return (float)(value / 65536.0); }

static edml_point point_from_q16(edml_point_q p)
{
    const edml_point q = {from_q16(p.x), from_q16(p.y), from_q16(p.z)};
    return q;
}

edml_point_q point_to_q16(edml_point p)
{
    const edml_point_q q = {q16(p.x), q16(p.y), q16(p.z)};
    return q;
}

void pose_to_q16(edml_pose_q *out, const edml_pose *pose)
{
    memset(out, 0, sizeof *out);
    for (int j = 0; j < EDML_JOINTS; j++) {
        out->joint[j].x = q16(pose->joint[j].x);
        out->joint[j].y = q16(pose->joint[j].y);
        out->joint[j].z = q16(pose->joint[j].z);
    }
    out->misfit = q16(pose->misfit);
    out->seen = pose->seen;
}

static void pose_from_q16(edml_pose *out, const edml_pose_q *pose)
{
    for (int j = 0; j < EDML_JOINTS; j++) out->joint[j] = point_from_q16(pose->joint[j]);
    out->misfit = from_q16(pose->misfit);
    out->seen = pose->seen;
}

edml_camera_q camera_to_q16(edml_camera camera)
{
    const edml_camera_q out = {q16(camera.fx), q16(camera.fy), q16(camera.cx), q16(camera.cy)};
    return out;
}

static edml_work_q memory;
static int32_t values[EDML_PAIRS];
static edml_point_q24 points[EDML_JOINTS];
static edml_keypoint_q keypoints[EDML_JOINTS];

void image_to_q24(edml_image_q *out, const edml_image *image)
{
    memset(out, 0, sizeof *out);
    all_q24(&out->at[0].u, &image->at[0].u, 2 * EDML_JOINTS);
    all_q24(&out->down.u, &image->down.u, 2);
    out->seen = image->seen;
}

edml_status q24_body_frame(edml_image *image, const edml_keypoint in[EDML_JOINTS], int fewest_joints,
                           const edml_imputation *imputation)
{
    edml_image_q framed;
    if (in != NULL) to_q16(keypoints, in);
    const edml_status status = edml_body_frame_q(image != NULL ? &framed : NULL,
                                                 in != NULL ? keypoints : NULL, fewest_joints, imputation);
    if (status != EDML_OK) return status;
    all_floats(&image->at[0].u, &framed.at[0].u, 2 * EDML_JOINTS);
    all_floats(&image->down.u, &framed.down.u, 2);
    image->seen = framed.seen;
    return status;
}

void q24_edm(float edm[EDML_PAIRS], const edml_image *image)
{
    edml_image_q given;
    image_to_q24(&given, image);
    edml_edm_q(values, &given);
    all_floats(edm, values, EDML_PAIRS);
}

edml_status q24_predict(edml_prediction *out, const edml_image *image, const edml_point *up,
                        const edml_model *model, void *work, size_t work_bytes)
{
    static edml_prediction_q said;
    edml_image_q given;
    edml_point_q24 upwards;
    (void)work, (void)work_bytes;
    image_to_q24(&given, image);
    memset(&said, 0, sizeof said);
    if (up != NULL) all_q24(&upwards.x, &up->x, 3);
    const edml_status status = edml_predict_q(&said, &given, up != NULL ? &upwards : NULL, model, &memory,
                                              sizeof memory);
    if (status != EDML_OK) return status;
    all_floats(out->distance, said.distance, EDML_PAIRS);
    all_floats(out->share, said.share, EDML_JOINTS);
    all_floats(&out->x[0].x, &said.x[0].x, 3 * EDML_JOINTS);
    return status;
}

void q24_jacobi(edml_eigen *eigen, const edml_matrix *a)
{
    static edml_matrix_q matrix;
    static edml_eigen_q found;
    for (int i = 0; i < EDML_JOINTS; i++) /* below the diagonal there may be anything */
        all_q24(&matrix.at[i][i], &a->at[i][i], EDML_JOINTS - i);
    edml_jacobi_q(&found, &matrix);
    all_floats(eigen->value, found.value, EDML_JOINTS);
    for (int k = 0; k < EDML_JOINTS; k++) all_floats(eigen->vector[k], found.vector[k], EDML_JOINTS);
}

void q24_mds(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS], edml_work *work)
{
    (void)work;
    all_q24(values, distance, EDML_PAIRS);
    edml_mds_q(points, values, &memory);
    all_floats(&x->x, &points->x, 3 * EDML_JOINTS);
}

int q24_refine(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS], edml_objective objective,
               int steps, edml_work *work)
{
    (void)work;
    all_q24(values, distance, EDML_PAIRS);
    all_q24(&points->x, &x->x, 3 * EDML_JOINTS);
    const int taken = edml_refine_q(points, values, objective, steps, &memory);
    all_floats(&x->x, &points->x, 3 * EDML_JOINTS);
    return taken;
}

float q24_stress(const edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS],
                 edml_objective objective)
{
    all_q24(values, distance, EDML_PAIRS);
    all_q24(&points->x, &x->x, 3 * EDML_JOINTS);
    return to_float(edml_stress_q(points, values, objective));
}

float q24_mirror(edml_point x[EDML_JOINTS], const edml_model *model)
{
    all_q24(&points->x, &x->x, 3 * EDML_JOINTS);
    const int32_t margin = edml_mirror_q(points, model);
    all_floats(&x->x, &points->x, 3 * EDML_JOINTS);
    return to_float(margin);
}

void q24_align(edml_point x[EDML_JOINTS], const edml_point onto[EDML_JOINTS], const edml_model *model)
{
    edml_point_q24 given[EDML_JOINTS];
    all_q24(&points->x, &x->x, 3 * EDML_JOINTS);
    all_q24(&given->x, &onto->x, 3 * EDML_JOINTS);
    edml_align_q(points, given, model);
    all_floats(&x->x, &points->x, 3 * EDML_JOINTS);
}

edml_status q24_orient(edml_point x[EDML_JOINTS], const edml_image *image)
{
    edml_image_q given;
    image_to_q24(&given, image);
    all_q24(&points->x, &x->x, 3 * EDML_JOINTS);
    const edml_status status = edml_orient_q(points, &given);
    if (status == EDML_OK) all_floats(&x->x, &points->x, 3 * EDML_JOINTS);
    return status;
}

float q24_fuse(edml_point x[EDML_JOINTS], const edml_image *image, const float share[EDML_JOINTS],
               const edml_model *model)
{
    edml_image_q given;
    image_to_q24(&given, image);
    all_q24(&points->x, &x->x, 3 * EDML_JOINTS);
    all_q24(values, share, EDML_JOINTS);
    const int32_t misfit = edml_fuse_q(points, &given, values, model);
    all_floats(&x->x, &points->x, 3 * EDML_JOINTS);
    return to_float(misfit);
}

edml_status q24_lift(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_point *up,
                     const edml_model *model, void *work, size_t work_bytes)
{
    (void)work_bytes;
    edml_pose_q lifted;
    edml_point_q upwards;
    if (in != NULL) to_q16(keypoints, in);
    if (up != NULL) upwards = point_to_q16(*up);
    const edml_status status = edml_lift_q(pose != NULL ? &lifted : NULL, in != NULL ? keypoints : NULL,
                                           up != NULL ? &upwards : NULL, model,
                                           work != NULL ? &memory : NULL, sizeof memory);
    if (status == EDML_OK) pose_from_q16(pose, &lifted);
    return status;
}

edml_status q24_lift_with_camera(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_point *up,
                                 const edml_camera *camera, const edml_model *model, void *work,
                                 size_t work_bytes)
{
    (void)work_bytes;
    edml_pose_q lifted;
    edml_point_q upwards;
    edml_camera_q by;
    if (in != NULL) to_q16(keypoints, in);
    if (up != NULL) upwards = point_to_q16(*up);
    if (camera != NULL) by = camera_to_q16(*camera);
    const edml_status status = edml_lift_with_camera_q(
        pose != NULL ? &lifted : NULL, in != NULL ? keypoints : NULL, up != NULL ? &upwards : NULL,
        camera != NULL ? &by : NULL, model, work != NULL ? &memory : NULL, sizeof memory);
    if (status == EDML_OK) pose_from_q16(pose, &lifted);
    return status;
}

/* At most 33 keypoints, in sets of 14 for to_q16(). */
void q24_adapt(edml_keypoint out[EDML_JOINTS], const edml_keypoint in[], const edml_format *format)
{
    edml_keypoint_q wide[3 * EDML_JOINTS], joint[EDML_JOINTS];
    edml_keypoint padded[3 * EDML_JOINTS] = {{0, 0, 0}};
    memcpy(padded, in, format->keypoints * sizeof *in);
    for (int n = 0; n < 3; n++) to_q16(wide + n * EDML_JOINTS, padded + n * EDML_JOINTS);
    edml_adapt_q(joint, wide, format);
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j].x = (float)(joint[j].x / 65536.0);
        out[j].y = (float)(joint[j].y / 65536.0);
        out[j].c = (float)(joint[j].c / 32768.0);
    }
}

static void from_placement_q16(edml_placement *out, const edml_placement_q *placed)
{
    for (int j = 0; j < EDML_JOINTS; j++) out->joint[j] = point_from_q16(placed->joint[j]);
    for (int i = 0; i < 3; i++) out->rotation[i] = point_from_q16(placed->rotation[i]);
    out->translation = point_from_q16(placed->translation);
    out->reprojection = from_q16(placed->reprojection);
    out->steps = placed->steps;
}

edml_status q24_place(edml_placement *placement, const edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                      const edml_camera *camera, void *work, size_t work_bytes)
{
    (void)work_bytes;
    edml_pose_q given;
    edml_camera_q by;
    edml_placement_q placed;
    if (pose != NULL) pose_to_q16(&given, pose);
    if (in != NULL) to_q16(keypoints, in);
    if (camera != NULL) by = camera_to_q16(*camera);
    const edml_status status = edml_place_q(
        placement != NULL ? &placed : NULL, pose != NULL ? &given : NULL, in != NULL ? keypoints : NULL,
        camera != NULL ? &by : NULL, work != NULL ? &memory : NULL, sizeof memory);
    if (status == EDML_OK) from_placement_q16(placement, &placed);
    return status;
}

edml_status q24_place_sweep(edml_placement *placement, edml_camera *camera, const edml_pose *pose,
                            const edml_keypoint in[EDML_JOINTS], float width, float height, void *work,
                            size_t work_bytes)
{
    (void)work_bytes;
    edml_pose_q given;
    edml_camera_q found;
    edml_placement_q placed;
    if (pose != NULL) pose_to_q16(&given, pose);
    if (in != NULL) to_q16(keypoints, in);
    const edml_status status = edml_place_sweep_q(
        placement != NULL ? &placed : NULL, camera != NULL ? &found : NULL, pose != NULL ? &given : NULL,
        in != NULL ? keypoints : NULL, q16(width), q16(height), work != NULL ? &memory : NULL,
        sizeof memory);
    if (status != EDML_OK) return status;
    from_placement_q16(placement, &placed);
    const edml_camera by = {from_q16(found.fx), from_q16(found.fy), from_q16(found.cx), from_q16(found.cy)};
    *camera = by;
    return status;
}

static void to_placement_q16(edml_placement_q *out, const edml_placement *placement)
{
    memset(out, 0, sizeof *out);
    for (int j = 0; j < EDML_JOINTS; j++) out->joint[j] = point_to_q16(placement->joint[j]);
    for (int i = 0; i < 3; i++) out->rotation[i] = point_to_q16(placement->rotation[i]);
    out->translation = point_to_q16(placement->translation);
    out->reprojection = q16(placement->reprojection);
    out->steps = placement->steps;
}

edml_status q24_path_follow(edml_path *path, edml_placement *placement, uint32_t time_ms)
{
    edml_path_q followed;
    edml_placement_q placed;
    if (path != NULL) {
        followed.at = point_to_q16(path->at);
        followed.rate = point_to_q16(path->rate);
        followed.time = path->time;
        followed.placements = path->placements;
    }
    if (placement != NULL) to_placement_q16(&placed, placement);
    const edml_status status = edml_path_follow_q(path != NULL ? &followed : NULL,
                                                  placement != NULL ? &placed : NULL, time_ms);
    if (status != EDML_OK) return status;
    path->at = point_from_q16(followed.at);
    path->rate = point_from_q16(followed.rate);
    path->time = followed.time;
    path->placements = followed.placements;
    from_placement_q16(placement, &placed);
    return status;
}

static void to_focal_q16(edml_focal_q *out, const edml_focal *focal)
{
    out->width = q16(focal->width);
    out->height = q16(focal->height);
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++) out->misfit[n] = q16(focal->misfit[n]);
    out->poses = focal->poses;
}

static void from_focal_q16(edml_focal *out, const edml_focal_q *focal)
{
    out->width = from_q16(focal->width);
    out->height = from_q16(focal->height);
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++) out->misfit[n] = from_q16(focal->misfit[n]);
    out->poses = focal->poses;
}

edml_status q24_focal_start(edml_focal *focal, float width, float height)
{
    edml_focal_q search;
    const edml_status status = edml_focal_start_q(focal != NULL ? &search : NULL, q16(width), q16(height));
    if (status == EDML_OK) from_focal_q16(focal, &search);
    return status;
}

edml_status q24_focal_add(edml_focal *focal, const edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                          void *work, size_t work_bytes)
{
    (void)work_bytes;
    edml_focal_q search;
    edml_pose_q given;
    if (focal != NULL) to_focal_q16(&search, focal);
    if (pose != NULL) pose_to_q16(&given, pose);
    if (in != NULL) to_q16(keypoints, in);
    const edml_status status = edml_focal_add_q(focal != NULL ? &search : NULL,
                                                pose != NULL ? &given : NULL, in != NULL ? keypoints : NULL,
                                                work != NULL ? &memory : NULL, sizeof memory);
    if (status == EDML_OK) from_focal_q16(focal, &search);
    return status;
}

edml_status q24_focal_camera(edml_camera *camera, const edml_focal *focal)
{
    edml_focal_q search;
    edml_camera_q found;
    if (focal != NULL) to_focal_q16(&search, focal);
    const edml_status status = edml_focal_camera_q(camera != NULL ? &found : NULL,
                                                   focal != NULL ? &search : NULL);
    if (status != EDML_OK) return status;
    const edml_camera by = {from_q16(found.fx), from_q16(found.fy), from_q16(found.cx), from_q16(found.cy)};
    *camera = by;
    return status;
}

edml_status q24_measure_body(edml_measured_body *measured, const edml_pose *pose)
{
    edml_measured_body_q state;
    edml_pose_q given;
    if (measured != NULL) {
        state.body.height = q16(measured->body.height);
        for (int n = 0; n < EDML_BONES; n++) state.body.bone[n] = q16(measured->body.bone[n]);
        memcpy(state.seen, measured->seen, sizeof state.seen);
        state.poses = measured->poses;
    }
    if (pose != NULL) pose_to_q16(&given, pose);
    const edml_status status = edml_measure_body_q(measured != NULL ? &state : NULL,
                                                   pose != NULL ? &given : NULL);
    if (status != EDML_OK) return status;
    for (int n = 0; n < EDML_BONES; n++) measured->body.bone[n] = from_q16(state.body.bone[n]);
    memcpy(measured->seen, state.seen, sizeof state.seen);
    measured->poses = state.poses;
    return status;
}

edml_status q24_fit_body(edml_pose *pose, const edml_body *body)
{
    edml_pose_q fitted;
    edml_body_q known;
    if (pose != NULL) pose_to_q16(&fitted, pose);
    if (body != NULL) known.height = q16(body->height);
    for (int n = 0; n < EDML_BONES && body != NULL; n++) known.bone[n] = q16(body->bone[n]);
    const edml_status status = edml_fit_body_q(pose != NULL ? &fitted : NULL, body != NULL ? &known : NULL);
    if (status != EDML_OK) return status;
    for (int j = 0; j < EDML_JOINTS; j++) pose->joint[j] = point_from_q16(fitted.joint[j]);
    return status;
}

edml_status q24_quality(float *quality, const edml_pose *pose)
{
    edml_pose_q given;
    int32_t found;
    if (pose != NULL) pose_to_q16(&given, pose);
    const edml_status status = edml_quality_q(quality != NULL ? &found : NULL,
                                              pose != NULL ? &given : NULL);
    if (status == EDML_OK) *quality = from_q16(found);
    return status;
}

edml_status q24_stand(edml_point out[EDML_JOINTS], const edml_pose *pose, edml_point up)
{
    edml_pose_q given;
    edml_point_q stood[EDML_JOINTS];
    const edml_point_q upwards = point_to_q16(up);
    if (pose != NULL) pose_to_q16(&given, pose);
    const edml_status status = edml_stand_q(out != NULL ? stood : NULL, pose != NULL ? &given : NULL,
                                            upwards);
    if (status != EDML_OK) return status;
    for (int j = 0; j < EDML_JOINTS; j++) out[j] = point_from_q16(stood[j]);
    return status;
}

edml_status q24_angles(float degrees[EDML_ANGLES], const edml_pose *pose, const edml_point *up)
{
    edml_pose_q given;
    edml_point_q upwards;
    int32_t found[EDML_ANGLES];
    if (pose != NULL) pose_to_q16(&given, pose);
    if (up != NULL) upwards = point_to_q16(*up);
    const edml_status status = edml_angles_q(degrees != NULL ? found : NULL, pose != NULL ? &given : NULL,
                                             up != NULL ? &upwards : NULL);
    for (int n = 0; n < EDML_ANGLES && status == EDML_OK; n++)
        degrees[n] = found[n] == EDML_NO_ANGLE ? NAN : from_q16(found[n]);
    return status;
}

edml_status q24_joint_limits(int *violations, const edml_pose *pose)
{
    edml_pose_q given;
    if (pose != NULL) pose_to_q16(&given, pose);
    return edml_joint_limits_q(violations, pose != NULL ? &given : NULL);
}

edml_status q24_reflect_by_joint_limits(int *fewer, edml_pose *pose)
{
    if (pose == NULL) return edml_reflect_by_joint_limits_q(fewer, NULL);
    edml_pose_q given, chosen;
    pose_to_q16(&given, pose);
    chosen = given;
    const edml_status status = edml_reflect_by_joint_limits_q(fewer, &chosen);
    if (memcmp(&given, &chosen, sizeof given) == 0) return status;
    for (int j = 0; j < EDML_JOINTS; j++) pose->joint[j] = point_from_q16(chosen.joint[j]);
    return status;
}
