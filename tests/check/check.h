/* The fixed-point lift in numbers that watch themselves.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_CHECK_H
#define EDML_CHECK_H

#include "edmlift.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Operations since the tally was last zeroed. */
typedef struct {
    long sums;      /* + - * / of whole numbers */
    long products;  /* MUL */
    long ratios;    /* DIV */
    long roots;     /* SQRT, HYPOT, NORM */
    long overflows; /* results, or numbers given to DIV and SQRT, that do not fit */
} check_tally;

/* edml_lift_q(), and what it took. */
edml_status check_lift(edml_pose_q *pose, const edml_keypoint_q in[EDML_JOINTS],
                       const edml_model *model, check_tally *tally);

/* What follows the network in a lift, of any distances: 0 to 3 m, Q24. */
void check_points(int32_t x[EDML_JOINTS][3], const int32_t distance[EDML_PAIRS],
                  const edml_keypoint_q in[EDML_JOINTS], const edml_model *model,
                  check_tally *tally);

/* edml_refine_q() of the points of check_points() before they are mirrored and turned. */
int check_refine(int32_t x[EDML_JOINTS][3], const int32_t distance[EDML_PAIRS],
                 edml_objective objective, int steps, check_tally *tally);

/* edml_place_q(), and what it took. */
edml_status check_place(edml_placement_q *placement, const edml_pose_q *pose,
                        const edml_keypoint_q in[EDML_JOINTS], const edml_camera_q *camera,
                        check_tally *tally);

/* edml_fit_body_q(), edml_quality_q() and edml_stand_q(), and what they took. */
edml_status check_fit_person(edml_pose_q *pose, const edml_body_q *owner, check_tally *tally);
int32_t check_quality(const edml_pose_q *pose, const edml_keypoint_q in[EDML_JOINTS],
                      check_tally *tally);
edml_status check_floor(edml_point_q out[EDML_JOINTS], const edml_pose_q *pose,
                        edml_point_q up, check_tally *tally);

/* edml_joint_limits_q() and edml_reflect_by_joint_limits_q(), and what they took. */
int check_limits(const edml_pose_q *pose, check_tally *tally);
int check_mirror_by_limits(edml_pose_q *pose, check_tally *tally);

#ifdef __cplusplus
}
#endif

#endif
