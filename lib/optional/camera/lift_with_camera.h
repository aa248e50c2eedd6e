/* A lift that knows the camera: it sees the person as a camera at the same place that looks at them.
 *
 * Off a camera's axis a person looks turned, by as much as the angle, and is lifted so.  To turn the camera
 * onto the person is exact geometry, and so is to turn the pose back.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_LIFT_WITH_CAMERA_H
#define EDML_LIFT_WITH_CAMERA_H

#include "../../api/pose.h"
#include "../../geometry/rotation.h"
#include "../../geometry/seen.h"
#include "../../geometry/unit_vector.h"
#include "line_of_sight.h"

#define VIEW_FOCAL PIXELS(4096) /* of the turned camera; any would do */

/* The rotation from the camera to one whose axis is the mean line of sight of the seen joints. */
static edml_status find_view(matrix3 *view, const edml_keypoint in[EDML_JOINTS], uint16_t seen,
                             const edml_camera *camera)
{
    const real part = REAL(1.0) / (real)count_seen(seen);
    point sum = {0, 0, 0}, ray;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!is_seen(seen, j)) continue;
        if (!line_of_sight(&ray, in[j], camera)) return EDML_ERR_CAMERA;
        add_multiple(&sum, part, ray);
    }
    *view = rotation_onto(over_length(sum, norm(sum)));
    return EDML_OK;
}

/* Keypoints as that camera has them. */
static edml_status turn_view(edml_keypoint out[EDML_JOINTS], const edml_keypoint in[EDML_JOINTS],
                             uint16_t seen, const edml_camera *camera, const matrix3 *view)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j] = in[j];
        point ray;
        if (!is_seen(seen, j) || !line_of_sight(&ray, in[j], camera)) continue;
        const point turned = rotate(view, ray);
        if (2 * turned.z < norm(ray)) return EDML_ERR_CAMERA; /* 60 degrees off: tangents to 1.8 */
        ASSUME(turned.z >= REAL(0.49)); /* half of a norm of 1 or more */
        /* the tangent of 60 degrees */
        out[j].x = MUL(VIEW_FOCAL, DIV_TO(REAL(1.8), turned.x, turned.z));
        out[j].y = MUL(VIEW_FOCAL, DIV_TO(REAL(1.8), turned.y, turned.z));
    }
    return EDML_OK;
}

edml_status edml_lift_with_camera(edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                                  const edml_point *up, const edml_camera *camera, const edml_model *model,
                                  void *work, size_t work_bytes)
{
    edml_keypoint turned[EDML_JOINTS];
    edml_pose lifted;
    edml_point turned_up;
    matrix3 view;
    if (pose == NULL || in == NULL || camera == NULL || model == NULL || work == NULL)
        return EDML_ERR_ARGUMENT;
    const uint16_t seen = seen_joints(in);
    if (!is_camera(camera)) return EDML_ERR_CAMERA;
    if (!are_finite(in, seen)) return EDML_ERR_NOT_FINITE;
    if (seen == 0) return EDML_ERR_TOO_FEW_JOINTS;
    edml_status status = find_view(&view, in, seen, camera);
    if (status == EDML_OK) status = turn_view(turned, in, seen, camera, &view);
    if (status == EDML_OK && up != NULL) {
        point direction;
        status = unit_vector(&direction, *up);
        if (status == EDML_OK) turned_up = api_point(rotate(&view, direction));
    }
    if (status == EDML_OK)
        status = edml_lift(&lifted, turned, up == NULL ? NULL : &turned_up, model, work, work_bytes);
    if (status != EDML_OK) return status;
    for (int j = 0; j < EDML_JOINTS; j++)
        lifted.joint[j] = api_point(rotate_back(&view, pose_joint(&lifted, j)));
    *pose = lifted;
    return EDML_OK;
}

#endif
