/* After the lift: how far joints are bent, how the trunk leans, and where the person faces. */
#include <stdio.h>

#include "edmlift.h"
#include "edmlift/angles.h"

static edml_work work;
static edml_pose pose;

static const edml_keypoint in[EDML_JOINTS] = {
    {512, 254, 1}, {509, 336, 1},                /* head, neck base */
    {461, 318, 1}, {452, 387, 1}, {489, 440, 1}, /* right shoulder, elbow, wrist */
    {556, 317, 1}, {571, 389, 1}, {0, 0, 0},     /* left; the wrist was not seen */
    {478, 466, 1}, {470, 561, 1}, {463, 655, 1}, /* right hip, knee, ankle */
    {537, 465, 1}, {551, 556, 1}, {590, 640, 1}, /* left */
};

int main(void)
{
    static const edml_point up = {0, -1, 0}; /* the camera is level */
    float degrees[EDML_ANGLES];

    edml_status status = edml_lift(&pose, in, &up, &edml_direct_w16, &work, sizeof work);
    if (status == EDML_OK) status = edml_angles(degrees, &pose, &up);
    if (status != EDML_OK) {
        printf("failed: %s\n", edml_status_name(status));
        return 1;
    }
    for (int n = 0; n < EDML_ANGLES; n++) {
        if (degrees[n] == degrees[n]) /* not NaN */
            printf("%-24s %6.1f\n", edml_angle_name(n), degrees[n]);
        else
            printf("%-24s      -\n", edml_angle_name(n));
    }
    if (degrees[EDML_R_KNEE_FLEXION] > 80 && degrees[EDML_L_KNEE_FLEXION] > 80) puts("a squat");
    return 0;
}
