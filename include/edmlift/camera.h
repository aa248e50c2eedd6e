/* The camera's frame: where a lifted pose is before a camera, in metres (docs/where-in-the-room.md).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDMLIFT_CAMERA_H
#define EDMLIFT_CAMERA_H

#include "../edmlift.h"
#include "fixed.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A pinhole camera, pixels.  Undistort the keypoints of a lens with distortion first. */
typedef struct {
    float fx, fy, cx, cy; /* focal lengths, > 0, and principal point */
} edml_camera;

/* edml_lift() by a camera that is known: as if it looked at the person.  Without it a person at the edge of a
 * wide picture is turned, by as much as they are off the camera's axis.
 *   EDML_ERR_CAMERA  also: not a camera; a joint more than 63 degrees off the camera's axis or 60 degrees off
 *                    the person */
edml_status edml_lift_with_camera(edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                                  const edml_point *up, const edml_camera *camera,
                                  const edml_model *model, void *work, size_t work_bytes);

typedef struct {
    edml_point joint[EDML_JOINTS]; /* metres, camera axes, origin at the camera's centre */
    edml_point rotation[3];        /* rows; joint = rotation * pose.joint + translation */
    edml_point translation;        /* metres: where the pose's origin, mid-hip, is */
    float reprojection; /* pixels: RMS distance of the seen joints' images from the keypoints, weighted by
                           confidence */
    uint16_t steps;     /* of the iterations, at most 53 */
} edml_placement;

/* Places a pose before the camera, so that its joints are seen where they were.  PnP by orthogonal iteration
 * (Lu, Hager, Mjolsness, "Fast and globally convergent pose estimation from video images", 2000) from two
 * starts, with Gauss-Newton steps, and a few more on the error in the image.
 *   pose  from edml_lift(), or any 14 points within 4 m of their origin, however rotated
 *   in    the keypoints that it was lifted from.  Each counts by its confidence, and not at all below a
 *         thousandth of the sum of all
 *   work  as for edml_lift(), and may be the same: an edml_work or larger
 * The distance is wrong by the factor by which the person's size is, because one image shows no more.  Takes
 * up to 1.7 KB of stack.  About 1 flat pose in 10,000 is given the wrong one of two rotations.
 * Besides EDML_ERR_ARGUMENT and EDML_ERR_WORK_TOO_SMALL:
 *   EDML_ERR_NOT_FINITE      a keypoint is not finite, or a joint is not within 4 m
 *   EDML_ERR_TOO_FEW_JOINTS  fewer than 7 joints seen
 *   EDML_ERR_DEGENERATE      joints or image on a line, or smaller than 1/64 m or 0.11 degrees (RMS)
 *   EDML_ERR_CAMERA          not a camera; a joint more than 63 degrees off the camera's axis or 60 degrees
 *                            off the person; a joint behind it, or much nearer than the person; a person
 *                            beyond 100 m; a joint that is off by more than the person's size */
edml_status edml_place(edml_placement *placement, const edml_pose *pose,
                       const edml_keypoint in[EDML_JOINTS], const edml_camera *camera, void *work,
                       size_t work_bytes);

/* edml_place() with a camera of unknown focal length.  Its principal point is the middle of the image.  Of
 * 12 focal lengths from 0.5 to 4 times the image's height it takes the one of least reprojection error
 * (section 4).  People some metres away look nearly the same through all of them: distance and focal length
 * are found together, and badly; only their ratio is found well.  Calibrate where distance matters.
 *   camera         the one that was chosen
 *   width, height  of the image, pixels, > 0; else EDML_ERR_CAMERA */
edml_status edml_place_sweep(edml_placement *placement, edml_camera *camera, const edml_pose *pose,
                             const edml_keypoint in[EDML_JOINTS], float width, float height, void *work,
                             size_t work_bytes);

/* ---- In fixed point ----------------------------------------------------------------------------- */

typedef struct {
    int32_t fx, fy, cx, cy; /* pixels, Q16, each under 8192 */
} edml_camera_q;

edml_status edml_lift_with_camera_q(edml_pose_q *pose, const edml_keypoint_q in[EDML_JOINTS],
                                    const edml_point_q *up, const edml_camera_q *camera,
                                    const edml_model *model, void *work, size_t work_bytes);

typedef struct { /* as edml_placement, Q16 */
    edml_point_q joint[EDML_JOINTS], rotation[3], translation;
    int32_t reprojection; /* pixels */
    uint16_t steps;
} edml_placement_q;

edml_status edml_place_q(edml_placement_q *placement, const edml_pose_q *pose,
                         const edml_keypoint_q in[EDML_JOINTS], const edml_camera_q *camera, void *work,
                         size_t work_bytes);
edml_status edml_place_sweep_q(edml_placement_q *placement, edml_camera_q *camera,
                               const edml_pose_q *pose, const edml_keypoint_q in[EDML_JOINTS],
                               int32_t width, int32_t height, void *work, size_t work_bytes);

#ifdef __cplusplus
}
#endif

#endif
