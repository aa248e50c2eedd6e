/* The public names and types in fixed point: each text that says edml_lift defines edml_lift_q here.
 * api_f32.h says what the other words mean.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_API_H
#define EDML_API_H

#include "edmlift.h"
#include "edmlift/angles.h"
#include "edmlift/body.h"
#include "edmlift/camera.h"
#include "edmlift/fixed.h"
#include "edmlift/many.h"
#include "edmlift/stages.h"
#include "edmlift/video.h"

#include "../number/compiler.h"
#include "../number/real_q24.h"

typedef edml_point_q24 point;
typedef int32_t pixels; /* Q16 */
typedef int16_t confidence;
typedef int32_t api_real; /* Q16 */

#define TO_API(a) (((a) + 128) >> 8)
#define FROM_API(a) ((a) * 256) /* |a| < 128 */
#define NO_ANGLE EDML_NO_ANGLE
#define IS_FINITE(a) is_in_range_q16(a)
#define MAX_PIXELS ((INT32_C(1) << 29) - 1)
#define API_MAX INT32_MAX
#define MAX_SLOPE (INT32_C(32) << 16)
#define MIN_MAGNITUDE (INT32_C(256) << 16) /* pixels: 24 bits, as many as a float has */
#define PIXELS(n) (INT32_C(n) << 16)       /* n < 8192 */
#define PARAM(number) (number).q24
#define WORK_BYTES(model) (model)->work_bytes_q
#define RUN_NETWORK edml__run_network_q
#define SCALE(model) (model)->scale_q

/* Coordinates within 8192 pixels; confidences always. */
static inline int is_in_range_q16(int32_t a) { return a > -(INT32_C(1) << 29) && a < INT32_C(1) << 29; }

/* Types */
#define edml_keypoint edml_keypoint_q
#define edml_point edml_point_q
#define edml_pose edml_pose_q
#define edml_work edml_work_q
#define edml_camera edml_camera_q
#define edml_placement edml_placement_q
#define edml_body edml_body_q
#define edml_measured_body edml_measured_body_q
#define edml_path edml_path_q
#define edml_focal edml_focal_q
#define edml_smoothing edml_smoothing_q
#define edml_moving edml_moving_q
#define edml_tracked_joint edml_tracked_joint_q
#define edml_track edml_track_q
#define edml_image edml_image_q
#define edml_image_point edml_image_point_q
#define edml_prediction edml_prediction_q
#define edml_matrix edml_matrix_q
#define edml_eigen edml_eigen_q
#define edml_plane_rotation edml_plane_rotation_q

/* Functions */
#define edml_adapt edml_adapt_q
#define edml_body_frame edml_body_frame_q
#define edml_edm edml_edm_q
#define edml_predict edml_predict_q
#define edml_jacobi edml_jacobi_q
#define edml_mds edml_mds_q
#define edml_refine edml_refine_q
#define edml_stress edml_stress_q
#define edml_mirror edml_mirror_q
#define edml_align edml_align_q
#define edml_orient edml_orient_q
#define edml_fuse edml_fuse_q
#define edml__scale_and_align edml__scale_and_align_q
#define edml__scale_and_orient edml__scale_and_orient_q
#define edml_lift edml_lift_q
#define edml_lift_with_camera edml_lift_with_camera_q
#define edml_lift_many edml_lift_many_q
#define edml_adapt_many edml_adapt_many_q
#define edml_track_start edml_track_start_q
#define edml_track_lift edml_track_lift_q
#define edml_track_distance edml_track_distance_q
#define edml_track_swap_sides edml_track_swap_sides_q
#define edml_place edml_place_q
#define edml_place_sweep edml_place_sweep_q
#define edml_path_start edml_path_start_q
#define edml_path_follow edml_path_follow_q
#define edml_focal_start edml_focal_start_q
#define edml_focal_add edml_focal_add_q
#define edml_focal_camera edml_focal_camera_q
#define edml_fit_body edml_fit_body_q
#define edml_measure_start edml_measure_start_q
#define edml_measure_body edml_measure_body_q
#define edml_quality edml_quality_q
#define edml_stand edml_stand_q
#define edml_angles edml_angles_q
#define edml_joint_limits edml_joint_limits_q
#define edml_reflect_by_joint_limits edml_reflect_by_joint_limits_q

#endif
