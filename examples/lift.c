#include <stdio.h>
#include "edmlift.h"

int main(void) { /* x and y in pixels, confidence; the left wrist was not seen */
    edml_keypoint in[EDML_JOINTS] = {{512, 254, 1}, {509, 336, 1}, {461, 318, 1}, {452, 387, 1}, {489, 440, 1},
        {556, 317, 1}, {571, 389, 1}, {0, 0, 0}, {478, 466, 1}, {470, 561, 1}, {463, 655, 1}, {537, 465, 1},
        {551, 556, 1}, {590, 640, 1}};
    edml_pose pose;
    edml_work work;
    edml_status status = edml_lift(&pose, in, &edml_fconn_f32, &work);
    for (int j = 0; j < EDML_JOINTS && status == EDML_OK; j++)
        printf("%-14s %6.3f %6.3f %6.3f\n", edml_joint_name(j), pose.joint[j].x, pose.joint[j].y, pose.joint[j].z);
    return puts(edml_status_name(status)) < 0 || status != EDML_OK;
}
