/* For tests of both arithmetics whose text is in floats: compiled with -DEDML_TEST_Q24, the fixed-point stages
 * have the names of the float ones, and convert on the way in and out (q24.h).  native.h is for tests that need
 * an arithmetic's own numbers.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_TEST_AS_FLOAT_H
#define EDML_TEST_AS_FLOAT_H

#include "helpers.h"

#ifdef EDML_TEST_Q24
#define edml_body_frame q24_body_frame
#define edml_edm q24_edm
#define edml_predict q24_predict
#define edml_jacobi q24_jacobi
#define edml_mds q24_mds
#define edml_refine q24_refine
#define edml_stress q24_stress
#define edml_mirror q24_mirror
#define edml_align q24_align
#define edml_orient q24_orient
#define edml_fuse q24_fuse
#define edml_lift q24_lift
#define edml_lift_with_camera q24_lift_with_camera
#define edml_adapt q24_adapt
#define edml_place q24_place
#define edml_place_sweep q24_place_sweep
#define edml_path_follow q24_path_follow
#define edml_focal_start q24_focal_start
#define edml_focal_add q24_focal_add
#define edml_focal_camera q24_focal_camera
#define edml_measure_body q24_measure_body
#define edml_fit_body q24_fit_body
#define edml_quality q24_quality
#define edml_stand q24_stand
#define edml_angles q24_angles
#define edml_joint_limits q24_joint_limits
#define edml_reflect_by_joint_limits q24_reflect_by_joint_limits
#define edml_fconn_f32 edml_fconn_w16
#define edml_direct_f32 edml_direct_w16
#define edml_distances_f32 edml_distances_w16
#endif

#endif
