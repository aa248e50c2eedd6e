/* After the lift: is the pose good, how tall is the person, and where is the floor? */
#include <stdio.h>

#include "edmlift.h"
#include "edmlift/body.h"

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
    static const edml_body owner = {.height = 1.68F}; /* metres, barefoot; bones are unknown */
    static const edml_point up = {0, -1, 0};          /* the camera is level */
    uint8_t millimetres[EDML_JOINTS];
    edml_point standing[EDML_JOINTS];
    float quality = 0;
    int violations = 0;

    edml_status status = edml_lift(&pose, in, &up, &edml_distances_w16, &work, sizeof work);
    if (status == EDML_OK) status = edml_quality(&quality, &pose); /* before edml_fit_body() */
    if (status == EDML_OK) status = edml_joint_limits(&violations, &pose);
    if (status == EDML_OK) status = edml_uncertainty(millimetres, pose.seen);
    if (status == EDML_OK) status = edml_fit_body(&pose, &owner);
    if (status == EDML_OK) status = edml_stand(standing, &pose, up);
    if (status != EDML_OK) {
        printf("failed: %s\n", edml_status_name(status));
        return 1;
    }
    printf("quality %.2f: %s\n", quality, quality < 0.5F ? "drop this pose" : "keep this pose");
    printf("bones beyond the joint limits: %d of 9\n", violations);
    printf("error to expect: left wrist (not seen) %d mm, right wrist (seen) %d mm\n",
           millimetres[EDML_L_WRIST], millimetres[EDML_R_WRIST]);
    printf("head: %.2f m above the floor\n", standing[EDML_HEAD].y);
    return 0;
}
