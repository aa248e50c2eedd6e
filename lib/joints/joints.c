/* Names, bones and mirror pairs of the joints.
 *
 * SPDX-License-Identifier: MIT
 */
#include "edmlift.h"

const edml_bone edml_bones[EDML_BONES] = {
    {EDML_NECK_BASE, EDML_HEAD},  {EDML_NECK_BASE, EDML_R_SHOULDER}, {EDML_R_SHOULDER, EDML_R_ELBOW},
    {EDML_R_ELBOW, EDML_R_WRIST}, {EDML_NECK_BASE, EDML_L_SHOULDER}, {EDML_L_SHOULDER, EDML_L_ELBOW},
    {EDML_L_ELBOW, EDML_L_WRIST}, {EDML_NECK_BASE, EDML_R_HIP},      {EDML_R_HIP, EDML_R_KNEE},
    {EDML_R_KNEE, EDML_R_ANKLE},  {EDML_NECK_BASE, EDML_L_HIP},      {EDML_L_HIP, EDML_L_KNEE},
    {EDML_L_KNEE, EDML_L_ANKLE},
};

const uint8_t edml_mirror_joint[EDML_JOINTS] = {
    EDML_HEAD,       EDML_NECK_BASE, EDML_L_SHOULDER, EDML_L_ELBOW, EDML_L_WRIST,
    EDML_R_SHOULDER, EDML_R_ELBOW,   EDML_R_WRIST,    EDML_L_HIP,   EDML_L_KNEE,
    EDML_L_ANKLE,    EDML_R_HIP,     EDML_R_KNEE,     EDML_R_ANKLE,
};

const char *edml_joint_name(int joint)
{
    static const char names[EDML_JOINTS][15] = {
        "head",          "neck_base",  "right_shoulder", "right_elbow", "right_wrist",
        "left_shoulder", "left_elbow", "left_wrist",     "right_hip",   "right_knee",
        "right_ankle",   "left_hip",   "left_knee",      "left_ankle",
    };
    return joint >= 0 && joint < EDML_JOINTS ? names[joint] : "?";
}
