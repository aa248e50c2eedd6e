/* Names of angles, in the order of enum edml_angle.
 *
 * SPDX-License-Identifier: MIT
 */
#include "edmlift/angles.h"

static const char angle_names[EDML_ANGLES][25] = {
    "right_elbow_flexion",
    "left_elbow_flexion",
    "right_knee_flexion",
    "left_knee_flexion",
    "right_hip_flexion",
    "left_hip_flexion",
    "right_hip_abduction",
    "left_hip_abduction",
    "right_shoulder_elevation",
    "left_shoulder_elevation",
    "right_shoulder_plane",
    "left_shoulder_plane",
    "right_shoulder_flexion",
    "left_shoulder_flexion",
    "right_shoulder_abduction",
    "left_shoulder_abduction",
    "trunk_lean",
    "trunk_lean_forward",
    "trunk_lean_right",
    "heading",
};

const char *edml_angle_name(int angle)
{
    return angle >= 0 && angle < EDML_ANGLES ? angle_names[angle] : "?";
}
