/* The angles of a lifted pose, in degrees (docs/angles.md).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDMLIFT_ANGLES_H
#define EDMLIFT_ANGLES_H

#include "../edmlift.h"
#include "fixed.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Someone who stands upright with hanging arms and faces a level camera has 0 in all of them, but
 * for SHOULDER_PLANE, which arms that hang do not have.
 *
 *                      what, and which way it is positive                        range
 *   ELBOW_FLEXION      between upper arm and forearm: 0 straight, 180 folded     0 to 180
 *   KNEE_FLEXION       between thigh and shin, the same                          0 to 180
 *   HIP_FLEXION        of the thigh in the pelvis's sagittal plane, forward      -180 to 180
 *   HIP_ABDUCTION      of the thigh out of that plane, away from the other leg   -90 to 90
 *   SHOULDER_ELEVATION of the upper arm from where it hangs along the trunk      0 to 180
 *   SHOULDER_PLANE     the plane of elevation: 0 sideways, 90 forward,           -180 to 180
 *                      180 to the other side, -90 back
 *   SHOULDER_FLEXION   of the upper arm, seen from the side: forward             -90 to 270
 *   SHOULDER_ABDUCTION of the upper arm, seen from the front: away from the      -90 to 270
 *                      trunk
 *   TRUNK_LEAN         of the trunk with the vertical: 0 upright, 90 lying,      0 to 180
 *                      180 head down
 *   TRUNK_LEAN_FORWARD of the trunk, seen from its side: forward                 -180 to 180
 *   TRUNK_LEAN_RIGHT   of the trunk, out of that plane, to the subject's right   -90 to 90
 *   HEADING            of the torso about the vertical: 0 faces the camera,      -180 to 180
 *                      90 the image's right, 180 away from the camera
 *
 * The trunk is the line from between the hips to the neck base; it also stands for the pelvis's and the
 * thorax's upward axis.  Pelvis: its z axis is the line of the hips, to the right; x points forward, at a right
 * angle to z and the trunk (Wu et al. 2002, whose adduction is positive instead).  Thorax: its y axis is the
 * trunk; x points forward, at a right angle to the trunk and the line of the shoulders (Wu et al. 2005, whose
 * elevation is negative instead).  The torso faces at a right angle to the vertical and to the line from its
 * left to its right side, the mean of shoulders and hips.
 *
 * 14 points do not tell: rotation of upper arms, thighs and forearms about themselves, how far elbows and knees
 * are bent the wrong way or sideways, tilt of the pelvis and bending of the spine (which are in the angles of
 * hips and trunk), shoulder blades, wrists, feet. */
enum edml_angle {
    EDML_R_ELBOW_FLEXION, /* the left one of a pair comes behind its right one */
    EDML_L_ELBOW_FLEXION,
    EDML_R_KNEE_FLEXION,
    EDML_L_KNEE_FLEXION,
    EDML_R_HIP_FLEXION,
    EDML_L_HIP_FLEXION,
    EDML_R_HIP_ABDUCTION,
    EDML_L_HIP_ABDUCTION,
    EDML_R_SHOULDER_ELEVATION,
    EDML_L_SHOULDER_ELEVATION,
    EDML_R_SHOULDER_PLANE,
    EDML_L_SHOULDER_PLANE,
    EDML_R_SHOULDER_FLEXION,
    EDML_L_SHOULDER_FLEXION,
    EDML_R_SHOULDER_ABDUCTION,
    EDML_L_SHOULDER_ABDUCTION,
    EDML_TRUNK_LEAN,
    EDML_TRUNK_LEAN_FORWARD,
    EDML_TRUNK_LEAN_RIGHT,
    EDML_HEADING,
    EDML_ANGLES
};

const char *edml_angle_name(int angle); /* "right_elbow_flexion"; "?" when out of range */

/* Measures all angles of a pose.
 *   degrees  [EDML_ANGLES], in the order of enum edml_angle.  NaN where a joint that the angle needs was not
 *            seen (pose->seen), and where there is no direction to measure: a bone of no length, a bone within
 *            14.5 degrees of the perpendicular to the plane in which its angle is measured (the plane of
 *            elevation of an arm that hangs, the flexion of one that is held out sideways), the heading
 *            (and the parts of the lean, which are told from it) of someone who lies on a side, the heading
 *            before a camera that looks straight down or up
 *   up       the upward direction in the camera's axes, of any length, as edml_lift() takes it; NULL: the
 *            camera is level.  Only TRUNK_LEAN... and HEADING depend on it
 *   EDML_ERR_NOT_FINITE  a joint is not within 4 m, or up is not finite
 *   EDML_ERR_DEGENERATE  up is zero */
edml_status edml_angles(float degrees[EDML_ANGLES], const edml_pose *pose, const edml_point *up);

/* ---- In fixed point: degrees in Q16 ------------------------------------------------------------- */

#define EDML_NO_ANGLE INT32_MIN /* where the float form has NaN */

/*   up  in any unit, each component within 2^29 */
edml_status edml_angles_q(int32_t degrees[EDML_ANGLES], const edml_pose_q *pose, const edml_point_q *up);

#ifdef __cplusplus
}
#endif

#endif
