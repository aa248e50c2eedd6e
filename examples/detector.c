/* From a detector to a pose: MoveNet's 17 keypoints, as its tensor has them. */
#include <stdio.h>

#include "edmlift.h"

#define SIDE 256.0F    /* pixels of MoveNet's square input */
#define THRESHOLD 0.3F /* scores up to this one are not seen */

static edml_work work;

/* MoveNet gives y before x, both divided by the side of its input. */
static void read_movenet(edml_keypoint out[17], const float tensor[17][3])
{
    for (int k = 0; k < 17; k++) {
        out[k].x = tensor[k][1] * SIDE;
        out[k].y = tensor[k][0] * SIDE;
        out[k].c = tensor[k][2] > THRESHOLD ? tensor[k][2] : 0;
    }
}

int main(void)
{
    static const float tensor[17][3] = {
        /* y, x, score */
        {0.265F, 0.516F, 0.8F}, /* nose */
        {0.250F, 0.527F, 0.7F}, /* left eye */
        {0.250F, 0.505F, 0.8F}, /* right eye */
        {0.254F, 0.538F, 0.6F}, /* left ear */
        {0.254F, 0.486F, 0.7F}, /* right ear */
        {0.317F, 0.556F, 0.9F}, /* left shoulder */
        {0.318F, 0.461F, 0.9F}, /* right shoulder */
        {0.389F, 0.571F, 0.8F}, /* left elbow */
        {0.387F, 0.452F, 0.9F}, /* right elbow */
        {0.445F, 0.560F, 0.1F}, /* left wrist: a guess, as its score says */
        {0.440F, 0.489F, 0.8F}, /* right wrist */
        {0.465F, 0.537F, 0.9F}, /* left hip */
        {0.466F, 0.478F, 0.9F}, /* right hip */
        {0.556F, 0.551F, 0.8F}, /* left knee */
        {0.561F, 0.470F, 0.9F}, /* right knee */
        {0.640F, 0.590F, 0.8F}, /* left ankle */
        {0.655F, 0.463F, 0.8F}, /* right ankle */
    };
    edml_keypoint seen[17], joints[EDML_JOINTS];
    edml_pose pose;
    read_movenet(seen, tensor);
    edml_adapt(joints, seen, &edml_coco17);
    edml_status status = edml_lift(&pose, joints, NULL, &edml_distances_w16, &work, sizeof work);
    if (status != EDML_OK) {
        printf("no pose: %s\n", edml_status_name(status));
        return 1;
    }
    for (int j = 0; j < EDML_JOINTS; j++)
        printf("%-14s %s %6.3f %6.3f %6.3f\n", edml_joint_name(j),
               pose.seen >> j & 1 ? "seen   " : "imputed", pose.joint[j].x, pose.joint[j].y,
               pose.joint[j].z);
    return 0;
}
