/* The fixed-point functions in integers that watch themselves.  Results are those of the library, bit for
 * bit.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_OVERFLOW_H
#define EDML_OVERFLOW_H

#include "edmlift/angles.h"
#include "edmlift/body.h"
#include "edmlift/camera.h"
#include "edmlift/stages.h"
#include "edmlift/video.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Operations since the tally was last zeroed. */
typedef struct {
    long sums;      /* + - * / of integers */
    long products;  /* MUL */
    long ratios;    /* DIV */
    long roots;     /* SQRT, HYPOT, NORM */
    long overflows; /* results, or numbers given to DIV and SQRT, that do not fit */
} checked_tally;

/* edml_lift_q() and edml_lift_with_camera_q(), and what they took. */
edml_status checked_lift(edml_pose_q *pose, const edml_keypoint_q in[EDML_JOINTS], const edml_point_q *up,
                         const edml_model *model, checked_tally *tally);
edml_status checked_lift_with_camera(edml_pose_q *pose, const edml_keypoint_q in[EDML_JOINTS],
                                     const edml_point_q *up, const edml_camera_q *camera,
                                     const edml_model *model, checked_tally *tally);

/* The frames of one video, one after the other: edml_track_start_q(), whose settings `set` may replace;
 * edml_track_distance_q() and edml_track_lift_q(), and what the two took. */
void checked_track_start(const edml_track_q *set);
edml_status checked_track_lift(edml_pose_q *pose, int32_t *distance, const edml_keypoint_q in[EDML_JOINTS],
                               uint32_t time_ms, const edml_model *model, checked_tally *tally);

/* edml_refine_q() of the points of edml_mds_q() or of these, and the objective before it.
 *   distance  0 to 3 m, Q24 */
int checked_refine(int32_t x[EDML_JOINTS][3], const int32_t distance[EDML_PAIRS], edml_objective objective,
                   int steps, checked_tally *tally);
int checked_refine_points(edml_point_q24 x[EDML_JOINTS], const int32_t distance[EDML_PAIRS],
                          edml_objective objective, int steps, checked_tally *tally);

/* Stages alone, and what they took: edml_body_frame_q(), edml_predict_q() as far as the model gives something,
 * edml_jacobi_q() without its work memory, edml_align_q() and edml_orient_q(). */
edml_status checked_body_frame(edml_image_q *image, const edml_keypoint_q in[EDML_JOINTS],
                               int fewest_joints, const edml_imputation *imputation, checked_tally *tally);
edml_status checked_predict(edml_prediction_q *out, const edml_image_q *image, const edml_point_q24 *up,
                            const edml_model *model, checked_tally *tally);
void checked_jacobi(edml_eigen_q *eigen, const edml_matrix_q *a, checked_tally *tally);
void checked_align(edml_point_q24 x[EDML_JOINTS], const edml_point_q24 onto[EDML_JOINTS],
                   const edml_model *model, checked_tally *tally);
edml_status checked_orient(edml_point_q24 x[EDML_JOINTS], const edml_image_q *image, checked_tally *tally);

/* edml_adapt_q(), and what it took. */
void checked_adapt(edml_keypoint_q out[EDML_JOINTS], const edml_keypoint_q in[], const edml_format *format,
                   checked_tally *tally);

/* edml_place_q() and edml_place_sweep_q(), and what they took. */
edml_status checked_place(edml_placement_q *placement, const edml_pose_q *pose,
                          const edml_keypoint_q in[EDML_JOINTS], const edml_camera_q *camera,
                          checked_tally *tally);
edml_status checked_place_sweep(edml_placement_q *placement, edml_camera_q *camera, const edml_pose_q *pose,
                                const edml_keypoint_q in[EDML_JOINTS], int32_t width, int32_t height,
                                checked_tally *tally);

/* edml_path_follow_q(), and what it took; and edml_focal_add_q() followed by edml_focal_camera_q(). */
edml_status checked_path_follow(edml_path_q *path, edml_placement_q *placement, uint32_t time_ms,
                                checked_tally *tally);
edml_status checked_focal_add(edml_focal_q *focal, edml_camera_q *camera, const edml_pose_q *pose,
                              const edml_keypoint_q in[EDML_JOINTS], checked_tally *tally);

/* edml_measure_body_q(), and what it took. */
edml_status checked_measure_body(edml_measured_body_q *measured, const edml_pose_q *pose,
                                 checked_tally *tally);

/* edml_fit_body_q(), edml_quality_q() and edml_stand_q(), and what they took. */
edml_status checked_fit_body(edml_pose_q *pose, const edml_body_q *body, checked_tally *tally);
edml_status checked_quality(int32_t *quality, const edml_pose_q *pose, checked_tally *tally);
edml_status checked_stand(edml_point_q out[EDML_JOINTS], const edml_pose_q *pose, edml_point_q up,
                          checked_tally *tally);

/* edml_angles_q(), and what it took. */
edml_status checked_angles(int32_t degrees[EDML_ANGLES], const edml_pose_q *pose, const edml_point_q *up,
                           checked_tally *tally);

/* edml_joint_limits_q() and edml_reflect_by_joint_limits_q(), and what they took. */
edml_status checked_joint_limits(int *violations, const edml_pose_q *pose, checked_tally *tally);
edml_status checked_reflect_by_joint_limits(int *fewer, edml_pose_q *pose, checked_tally *tally);

#ifdef __cplusplus
}
#endif

#endif
