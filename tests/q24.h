/* The fixed-point stages under the names and types of the float ones, so that a test of either is one
 * text: tests are compiled a second time with -DEDML_TEST_Q24.
 *
 * Numbers are rounded on their way in; keypoints out of range become the ends of it, as a saturating
 * conversion makes them.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TEST_Q24_H
#define EDML_TEST_Q24_H

#include "edmlift.h"

void to_q16(edml_keypoint_q out[EDML_JOINTS], const edml_keypoint in[EDML_JOINTS]);
void pose_to_q16(edml_pose_q *out, const edml_pose *pose);
edml_camera_q camera_to_q16(edml_camera camera);

edml_status q24_edm(float edm[EDML_PAIRS], const edml_keypoint in[EDML_JOINTS], int fewest,
                    float widest, const edml_imputation *completion);
void q24_net(float distance[EDML_PAIRS], const float edm[EDML_PAIRS], const edml_model *model,
             edml_work *work);
void q24_jacobi(edml_eigen *eigen, const edml_matrix *a);
void q24_mds(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS], edml_work *work);
int q24_refine(edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS],
               edml_objective objective, int steps, edml_work *work);
float q24_stress(const edml_point x[EDML_JOINTS], const float distance[EDML_PAIRS],
                 edml_objective objective);
float q24_mirror(edml_point x[EDML_JOINTS], const edml_model *model);
edml_status q24_orient(edml_point x[EDML_JOINTS], const edml_keypoint in[EDML_JOINTS], uint16_t seen);
void q24_blend(edml_point x[EDML_JOINTS], const edml_keypoint in[EDML_JOINTS], uint16_t seen,
               const edml_model *model);
edml_status q24_lift(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_model *model,
                     edml_work *work);
void q24_adapt(edml_keypoint out[EDML_JOINTS], const edml_keypoint in[], const edml_format *format);
edml_status q24_place(edml_placement *placement, const edml_pose *pose,
                      const edml_keypoint in[EDML_JOINTS], const edml_camera *camera,
                      edml_work *work);
edml_status q24_place_sweep(edml_placement *placement, edml_camera *camera, const edml_pose *pose,
                            const edml_keypoint in[EDML_JOINTS], float width, float height,
                            edml_work *work);

edml_status q24_fit_person(edml_pose *pose, const edml_body *owner);
float q24_quality(const edml_pose *pose, const edml_keypoint in[EDML_JOINTS]);
int q24_limits(const edml_pose *pose);
int q24_mirror_by_limits(edml_pose *pose);
edml_status q24_floor(edml_point out[EDML_JOINTS], const edml_pose *pose, edml_point up);

#ifdef EDML_TEST_Q24
#define edml_edm q24_edm
#define edml_predict q24_net
#define edml_jacobi q24_jacobi
#define edml_mds q24_mds
#define edml_refine q24_refine
#define edml_stress q24_stress
#define edml_mirror q24_mirror
#define edml_orient q24_orient
#define edml_fuse q24_blend
#define edml_lift q24_lift
#define edml_adapt q24_adapt
#define edml_place q24_place
#define edml_place_sweep q24_place_sweep
#define edml_fit_body q24_fit_person
#define edml_quality q24_quality
#define edml_stand q24_floor
#define edml_joint_limits q24_limits
#define edml_reflect_by_joint_limits q24_mirror_by_limits
#define edml_fconn_f32 edml_fconn_w16
#endif

#endif
