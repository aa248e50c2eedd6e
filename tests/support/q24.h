/* Conversions to and from fixed point, and the fixed-point stages with the types of the float ones.
 *
 * Numbers are rounded on their way in; keypoints out of range become the ends of it, as a saturating
 * conversion makes them.  Work memory is the wrappers' own; the one that is passed only must not be NULL.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TEST_Q24_H
#define EDML_TEST_Q24_H

#include "edmlift/angles.h"
#include "edmlift/body.h"
#include "edmlift/camera.h"
#include "edmlift/stages.h"

void to_q16(edml_keypoint_q out[EDML_JOINTS], const edml_keypoint in[EDML_JOINTS]);
void pose_to_q16(edml_pose_q *out, const edml_pose *pose);
edml_camera_q camera_to_q16(edml_camera camera);
edml_point_q point_to_q16(edml_point p);
void image_to_q24(edml_image_q *out, const edml_image *image);

edml_status q24_body_frame(edml_image *image, const edml_keypoint in[EDML_JOINTS], int fewest_joints,
                           const edml_imputation *imputation);
void q24_edm(float edm[EDML_PAIRS], const edml_image *image);
edml_status q24_predict(edml_prediction *out, const edml_image *image, const edml_point *up,
                        const edml_model *model, void *work, size_t work_bytes);
void q24_jacobi(edml_eigen *eigen, const edml_matrix *a);
void q24_mds(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS], edml_work *work);
int q24_refine(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS], edml_objective objective,
               int steps, edml_work *work);
float q24_stress(const edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS],
                 edml_objective objective);
float q24_mirror(edml_point x[EDML_JOINTS], const edml_model *model);
void q24_align(edml_point x[EDML_JOINTS], const edml_point onto[EDML_JOINTS], const edml_model *model);
edml_status q24_orient(edml_point x[EDML_JOINTS], const edml_image *image);
float q24_fuse(edml_point x[EDML_JOINTS], const edml_image *image, const float share[EDML_JOINTS],
               const edml_model *model);
edml_status q24_lift(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_point *up,
                     const edml_model *model, void *work, size_t work_bytes);
edml_status q24_lift_with_camera(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_point *up,
                                 const edml_camera *camera, const edml_model *model, void *work,
                                 size_t work_bytes);
void q24_adapt(edml_keypoint out[EDML_JOINTS], const edml_keypoint in[], const edml_format *format);
edml_status q24_place(edml_placement *placement, const edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                      const edml_camera *camera, void *work, size_t work_bytes);
edml_status q24_place_sweep(edml_placement *placement, edml_camera *camera, const edml_pose *pose,
                            const edml_keypoint in[EDML_JOINTS], float width, float height, void *work,
                            size_t work_bytes);

edml_status q24_path_follow(edml_path *path, edml_placement *placement, uint32_t time_ms);
edml_status q24_focal_start(edml_focal *focal, float width, float height);
edml_status q24_focal_add(edml_focal *focal, const edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                          void *work, size_t work_bytes);
edml_status q24_focal_camera(edml_camera *camera, const edml_focal *focal);
edml_status q24_measure_body(edml_measured_body *measured, const edml_pose *pose);
edml_status q24_fit_body(edml_pose *pose, const edml_body *body);
edml_status q24_quality(float *quality, const edml_pose *pose);
edml_status q24_joint_limits(int *violations, const edml_pose *pose);
edml_status q24_reflect_by_joint_limits(int *fewer, edml_pose *pose);
edml_status q24_stand(edml_point out[EDML_JOINTS], const edml_pose *pose, edml_point up);
edml_status q24_angles(float degrees[EDML_ANGLES], const edml_pose *pose, const edml_point *up);

#endif
