/* What comes after a lift: the body's size, quality and uncertainty, joint limits, the floor (docs/body.md).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDMLIFT_BODY_H
#define EDMLIFT_BODY_H

#include "../edmlift.h"
#include "fixed.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    float height;           /* metres, standing, barefoot, 0.5 to 2.5; 0: unknown */
    float bone[EDML_BONES]; /* metres, in the order of edml_bones; 0: unknown */
} edml_body;

/* Gives a pose the size of a known body, in place.  Known bones get their length and keep their direction.
 * One factor scales the others, so that the length from head to ankle is its proportion of the height;
 * without a height it is 1.  Mid-hip stays the origin; misfit stays that of the lift.
 * Call edml_quality() before, edml_place() after.
 *   EDML_ERR_BODY        negative, NaN, beyond the range, or bones that imply heights which differ by more
 *                        than a factor of 1.6
 *   EDML_ERR_NOT_FINITE  a joint of the pose is not within 4 m
 *   EDML_ERR_DEGENERATE  the pose would be more than twice as large, or less than an eighth, or a known bone
 *                        has no direction */
edml_status edml_fit_body(edml_pose *pose, const edml_body *body);

enum { EDML_MEASURED_POSES = 60 }; /* after which edml_measure_body() holds the bones */

/* The body of one person, as the poses of a video have it. */
typedef struct {
    edml_body body;           /* for edml_fit_body(): the bones so far, right and left alike; no height */
    uint8_t seen[EDML_BONES]; /* in how many poses a bone was */
    uint8_t poses;            /* measured so far, at most EDML_MEASURED_POSES */
} edml_measured_body;

void edml_measure_start(edml_measured_body *measured);

/* Measures the bones of a pose.  edml_fit_body() with measured->body then gives all poses of a video bones that
 * hardly change, and after EDML_MEASURED_POSES poses not at all.  A bone is the mean of the poses in which it is
 * seen, on the right or on the left, and of a first estimate: average proportions at the first pose's size, and
 * that pose.  A pose counts for no more than 10 % off the mean.  The result is always a body that edml_fit_body()
 * takes.
 *   pose  lifted; if a height is known, of that height already, by another edml_fit_body()
 *   EDML_ERR_NOT_FINITE  a joint is not within 4 m
 *   EDML_ERR_DEGENERATE  its bones add up to those of nobody of 0.52 to 2.4 m: the pose is not measured */
edml_status edml_measure_body(edml_measured_body *measured, const edml_pose *pose);

/* The probability that a pose's mean joint error is under 100 mm (rigid alignment, no scale), as far as its
 * misfit, its bones, the number of joints seen and how far the person is seen from the side tell.
 * docs/body.md says how well that holds.
 *   quality  0 to 1
 *   EDML_ERR_ARGUMENT        also: a misfit that no lift returns (negative or NaN)
 *   EDML_ERR_NOT_FINITE      a joint is not within 4 m
 *   EDML_ERR_TOO_FEW_JOINTS  fewer than 10 joints seen */
edml_status edml_quality(float *quality, const edml_pose *pose);

/* Mean error of each joint in millimetres after rigid alignment, given which joints were seen: for training
 * people, with a detector's noise, with the shipped networks, in float or fixed point.
 *   seen  bit j: joint j was seen; fewer than 10 are EDML_ERR_TOO_FEW_JOINTS */
edml_status edml_uncertainty(uint8_t millimetres[EDML_JOINTS], uint16_t seen);

/* Counts bones that point where no training person's did, seen from the torso or the bone before: head, upper
 * arms, forearms, thighs and shins (the rule of section 3.3, with a table of its own, 4 KB).  True poses
 * nearly always have none, their mirror images three or more.
 *   violations  0 to 9; a bone or a torso without direction counts
 *   EDML_ERR_NOT_FINITE  a joint is not within 4 m */
edml_status edml_joint_limits(int *violations, const edml_pose *pose);

/* Reflects the pose in depth, in place, if its mirror image violates fewer joint limits; on a tie leaves it
 * alone.
 *   fewer  how many fewer violations the result has than its mirror image; 0: the rule cannot tell
 *   EDML_ERR_NOT_FINITE  a joint is not within 4 m */
edml_status edml_reflect_by_joint_limits(int *fewer, edml_pose *pose);

/* Stands a pose on the floor.
 *   out  [14] metres: y up from the floor, on which the foot of the lower ankle stands; x right and z towards
 *        the camera, along the floor, from mid-hip.  The smallest rotation undoes the camera's roll and pitch
 *   up   the upward direction in the camera's axes, of any length: an accelerometer at rest, its axes rotated
 *        to the camera's; {0, -1, 0} for a level camera
 *   EDML_ERR_DEGENERATE  up is zero
 *   EDML_ERR_NOT_FINITE  up is not finite, or a joint is not within 4 m
 * The lower ankle is on the floor even if the person jumps, lies or sits. */
edml_status edml_stand(edml_point out[EDML_JOINTS], const edml_pose *pose, edml_point up);

/* ---- In fixed point: Q16 ------------------------------------------------------------------------ */

typedef struct {
    int32_t height, bone[EDML_BONES];
} edml_body_q;

edml_status edml_fit_body_q(edml_pose_q *pose, const edml_body_q *body);

typedef struct {
    edml_body_q body;
    uint8_t seen[EDML_BONES], poses;
} edml_measured_body_q;

void edml_measure_start_q(edml_measured_body_q *measured);
edml_status edml_measure_body_q(edml_measured_body_q *measured, const edml_pose_q *pose);
edml_status edml_quality_q(int32_t *quality, const edml_pose_q *pose);
edml_status edml_joint_limits_q(int *violations, const edml_pose_q *pose);
edml_status edml_reflect_by_joint_limits_q(int *fewer, edml_pose_q *pose);

/*   up  in any unit, each component within 2^29 */
edml_status edml_stand_q(edml_point_q out[EDML_JOINTS], const edml_pose_q *pose, edml_point_q up);

#ifdef __cplusplus
}
#endif

#endif
