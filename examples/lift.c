/* The program of the README: 14 joints of a picture in, a pose in metres out. */
#include <stdio.h>

#include "edmlift.h"

static edml_work work; /* 1.9 KB: static, because it is large for a task's stack */

int main(void)
{
    /* x and y in pixels, confidence; the detector did not see the left wrist */
    static const edml_keypoint in[EDML_JOINTS] = {
        {512, 254, 1}, {509, 336, 1},                /* head, neck base */
        {461, 318, 1}, {452, 387, 1}, {489, 440, 1}, /* right shoulder, elbow, wrist */
        {556, 317, 1}, {571, 389, 1}, {0, 0, 0},     /* left shoulder, elbow, wrist */
        {478, 466, 1}, {470, 561, 1}, {463, 655, 1}, /* right hip, knee, ankle */
        {537, 465, 1}, {551, 556, 1}, {590, 640, 1}, /* left hip, knee, ankle */
    };
    edml_pose pose;
    edml_status status = edml_lift(&pose, in, NULL, &edml_distances_w16, &work, sizeof work);
    if (status != EDML_OK) {
        printf("no pose: %s\n", edml_status_name(status));
        return 1;
    }
    for (int j = 0; j < EDML_JOINTS; j++)
        printf("%-14s %6.3f %6.3f %6.3f\n", edml_joint_name(j), pose.joint[j].x, pose.joint[j].y,
               pose.joint[j].z);
    return 0;
}
