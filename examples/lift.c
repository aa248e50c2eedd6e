/* The program of the README. */
#include <stdio.h>

#include "edmlift.h"

static edml_work work; /* 3.9 KB: static, because it is too large for most tasks' stacks */

int main(void)
{
    /* x and y in pixels, confidence; the left wrist was not seen */
    static const edml_keypoint in[EDML_JOINTS] = {
        {512, 254, 1}, {509, 336, 1},                /* head, neck base */
        {461, 318, 1}, {452, 387, 1}, {489, 440, 1}, /* right shoulder, elbow, wrist */
        {556, 317, 1}, {571, 389, 1}, {0, 0, 0},     /* left */
        {478, 466, 1}, {470, 561, 1}, {463, 655, 1}, /* right hip, knee, ankle */
        {537, 465, 1}, {551, 556, 1}, {590, 640, 1}, /* left */
    };
    edml_pose pose;
    edml_status status = edml_lift(&pose, in, &edml_fconn_w16, &work, sizeof work);
    for (int j = 0; j < EDML_JOINTS && status == EDML_OK; j++)
        printf("%-14s %6.3f %6.3f %6.3f\n", edml_joint_name(j), (double)pose.joint[j].x,
               (double)pose.joint[j].y, (double)pose.joint[j].z);
    puts(edml_status_name(status));
    return status != EDML_OK;
}
