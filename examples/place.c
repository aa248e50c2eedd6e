/* Where the person is: a pose before a calibrated camera, in metres from it. */
#include <stdio.h>

#include "edmlift.h"
#include "edmlift/camera.h"

static edml_work work; /* edml_lift_with_camera() and edml_place() share it */

int main(void)
{
    static const edml_keypoint in[EDML_JOINTS] = {
        {512, 254, 1}, {509, 336, 1},                /* head, neck base */
        {461, 318, 1}, {452, 387, 1}, {489, 440, 1}, /* right shoulder, elbow, wrist */
        {556, 317, 1}, {571, 389, 1}, {0, 0, 0},     /* left; the wrist was not seen */
        {478, 466, 1}, {470, 561, 1}, {463, 655, 1}, /* right hip, knee, ankle */
        {537, 465, 1}, {551, 556, 1}, {590, 640, 1}, /* left */
    };
    static const edml_camera camera = {1145, 1145, 500, 500}; /* fx, fy, cx, cy: pixels, as calibrated */
    static edml_pose pose;
    static edml_placement placement;
    edml_status status = edml_lift_with_camera(&pose, in, NULL, &camera, &edml_distances_w16, &work,
                                               sizeof work);
    if (status == EDML_OK) status = edml_place(&placement, &pose, in, &camera, &work, sizeof work);
    if (status != EDML_OK) {
        printf("not placed: %s\n", edml_status_name(status));
        return 1;
    }
    const edml_point hips = placement.translation, head = placement.joint[EDML_HEAD];
    printf("hips: %.2f m right, %.2f m down, %.2f m away\n", hips.x, hips.y, hips.z);
    printf("head: %.2f m right, %.2f m down, %.2f m away\n", head.x, head.y, head.z);
    printf("reprojection error: %.1f pixels\n", placement.reprojection);
    return 0;
}
