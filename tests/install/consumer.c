/* A program of somebody else, in the common part of C and C++. */
#include <edmlift.h>
#include <stdio.h>

int main(void)
{
    static const float at[EDML_JOINTS][2] = {{512, 240}, {508, 301}, {461, 318}, {452, 387}, {489, 440},
                                             {556, 317}, {571, 389}, {533, 430}, {478, 466}, {470, 561},
                                             {463, 655}, {537, 465}, {551, 556}, {590, 640}};
    edml_keypoint in[EDML_JOINTS];
    edml_pose pose;
    static edml_work work;
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = at[j][0];
        in[j].y = at[j][1];
        in[j].c = 1;
    }
    const edml_status status = edml_lift(&pose, in, NULL, &edml_distances_f32, &work, sizeof work);
    printf("%s %s\n", edml_status_name(status), edml_joint_name(EDML_L_ANKLE));
    return status == EDML_OK ? 0 : 1;
}
