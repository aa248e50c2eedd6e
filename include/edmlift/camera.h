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
 * wide picture is turned, by as much as they are off the camera's axis.  At most 1.1 KB of stack.
 *   EDML_ERR_CAMERA  also: not a camera; a joint more than 63 degrees off the camera's axis or 60 degrees off
 *                    the person */
edml_status edml_lift_with_camera(edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                                  const edml_point *up, const edml_camera *camera, const edml_model *model,
                                  void *work, size_t work_bytes);

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
 * The distance is wrong by the factor by which the person's size is, because one image shows no more.  At
 * most 2.0 KB of stack.  About 1 flat pose in 10,000 is given the wrong one of two rotations.
 * Besides EDML_ERR_ARGUMENT and EDML_ERR_WORK_TOO_SMALL:
 *   EDML_ERR_NOT_FINITE      a keypoint is not finite, or a joint is not within 4 m
 *   EDML_ERR_TOO_FEW_JOINTS  fewer than 7 joints seen
 *   EDML_ERR_DEGENERATE      joints or image on a line, or smaller than 1/64 m or 0.11 degrees (RMS)
 *   EDML_ERR_CAMERA          not a camera; a joint more than 63 degrees off the camera's axis or 60 degrees
 *                            off the person; a joint behind it, or much nearer than the person; a person
 *                            beyond 100 m along an axis; a joint that is off by more than the person's size */
edml_status edml_place(edml_placement *placement, const edml_pose *pose,
                       const edml_keypoint in[EDML_JOINTS], const edml_camera *camera, void *work,
                       size_t work_bytes);

/* edml_place() with a camera of unknown focal length.  Its principal point is the middle of the image.  Of
 * 12 focal lengths from 0.5 to 4 times the image's height it takes the one of least reprojection error
 * (section 4).  People some metres away look nearly the same through all of them: distance and focal length
 * are found together, and badly; only their ratio is found well.  Calibrate where distance matters.  At most
 * 2.3 KB of stack.
 *   camera         the one that was chosen
 *   width, height  of the image, pixels, > 0; else EDML_ERR_CAMERA */
edml_status edml_place_sweep(edml_placement *placement, edml_camera *camera, const edml_pose *pose,
                             const edml_keypoint in[EDML_JOINTS], float width, float height, void *work,
                             size_t work_bytes);

/* ---- Of a video --------------------------------------------------------------------------------- */

/* A person's way through the room, filtered from frame to frame, none delayed.  The caller keeps one for each
 * person. */
typedef struct {
    edml_point at, rate; /* metres from the camera's centre; metres per second */
    uint32_t time;       /* of the last placement, ms */
    uint16_t placements; /* that were followed since the start; 0: none */
} edml_path;

void edml_path_start(edml_path *path);

/* Filters where a placement is, in place: translation and joints are moved, all by the same way.  An alpha-beta
 * filter predicts that the person goes on as before.  Placements are many times noisier along the line of sight
 * than across it, so that the filter is much steadier along it.
 *   placement  of the video's next frame
 *   time_ms    of the frame, by any clock of milliseconds; it may wrap around
 * Frames may be left out, such as those without a placement.  The path starts anew after a second without any,
 * and where the person is farther from where they should be than a third of their distance.
 *   EDML_ERR_NOT_FINITE  a joint is not within 120 m along an axis
 *   EDML_ERR_CAMERA      a placement beyond 100 m along an axis, or not before the camera
 *   EDML_ERR_TIME        not later than the last placement, or over 24 days since */
edml_status edml_path_follow(edml_path *path, edml_placement *placement, uint32_t time_ms);

enum { EDML_FOCAL_LENGTHS = 12 }; /* that are tried: those of edml_place_sweep() */

/* The search for the focal length of one camera, whose principal point is the middle of the image. */
typedef struct {
    float width, height;              /* of the image, pixels */
    float misfit[EDML_FOCAL_LENGTHS]; /* how badly each explains the poses so far, 0 to 4 */
    uint16_t poses;                   /* so far */
} edml_focal;

/*   width, height  of the image, pixels, > 0; else EDML_ERR_CAMERA */
edml_status edml_focal_start(edml_focal *focal, float width, float height);

/* Adds what a pose tells of the focal length: the reprojection error with each one, compared with the least, in
 * proportion to the person's size in the image.  Costs 12 placements, and at most 2.4 KB of stack.
 *   pose, in, work  as for edml_place(); so is the status, if no focal length gives a placement
 *   EDML_ERR_CAMERA  also: edml_focal_start() was not called */
edml_status edml_focal_add(edml_focal *focal, const edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                           void *work, size_t work_bytes);

/* The camera of the focal length to be expected from the poses so far and from what cameras usually have: about
 * 1.2 times the image's height.  One pose tells about as much as a video does, because the errors of poses are
 * alike from frame to frame (docs/where-in-the-room.md).  A program that answers as frames come adds the first
 * one, and keeps that camera for the video; one that has all frames adds many, and then places all.
 *   EDML_ERR_CAMERA  no pose was added */
edml_status edml_focal_camera(edml_camera *camera, const edml_focal *focal);

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
edml_status edml_place_sweep_q(edml_placement_q *placement, edml_camera_q *camera, const edml_pose_q *pose,
                               const edml_keypoint_q in[EDML_JOINTS], int32_t width, int32_t height,
                               void *work, size_t work_bytes);

typedef struct { /* Q16 */
    edml_point_q at, rate;
    uint32_t time;
    uint16_t placements;
} edml_path_q;

void edml_path_start_q(edml_path_q *path);
edml_status edml_path_follow_q(edml_path_q *path, edml_placement_q *placement, uint32_t time_ms);

typedef struct { /* Q16 */
    int32_t width, height, misfit[EDML_FOCAL_LENGTHS];
    uint16_t poses;
} edml_focal_q;

edml_status edml_focal_start_q(edml_focal_q *focal, int32_t width, int32_t height);
edml_status edml_focal_add_q(edml_focal_q *focal, const edml_pose_q *pose,
                             const edml_keypoint_q in[EDML_JOINTS], void *work, size_t work_bytes);
edml_status edml_focal_camera_q(edml_camera_q *camera, const edml_focal_q *focal);

#ifdef __cplusplus
}
#endif

#endif
