/* Five detectors' output, as they have it in memory, to poses. */
#include <stdio.h>
#include <string.h>

#include "edmlift.h"

#define WIDTH 480.0F /* of the image */
#define HEIGHT 640.0F
#define THRESHOLD 0.1F /* scores up to this one are not seen */

static float score(float c) { return c > THRESHOLD ? c : 0; }

/* MoveNet's tensor: y, x, score; shares of the longer side of the image, which was padded to a square. */
static void from_movenet(edml_keypoint out[17], const float tensor[17][3])
{
    const float side = WIDTH > HEIGHT ? WIDTH : HEIGHT;
    for (int k = 0; k < 17; k++) {
        const float x = tensor[k][1] * side - (side - WIDTH) / 2;
        const float y = tensor[k][0] * side - (side - HEIGHT) / 2;
        out[k] = (edml_keypoint){x, y, score(tensor[k][2])};
    }
}

/* A detection of YOLO-pose: 4 numbers of a box, its confidence, and x, y, confidence in pixels. */
static void from_yolo(edml_keypoint out[17], const float detection[56])
{
    for (int k = 0; k < 17; k++) {
        const float *p = detection + 5 + 3 * k;
        out[k] = (edml_keypoint){p[0], p[1], p[0] == 0 && p[1] == 0 ? 0 : score(p[2])};
    }
}

/* BlazePose's landmarks: shares of the image; those outside it are guesses. */
typedef struct {
    float x, y, z, visibility;
} landmark;

static void from_blazepose(edml_keypoint out[33], const landmark in[33])
{
    for (int k = 0; k < 33; k++) {
        const int inside = in[k].x >= 0 && in[k].x <= 1 && in[k].y >= 0 && in[k].y <= 1;
        out[k] = (edml_keypoint){in[k].x * WIDTH, in[k].y * HEIGHT, inside ? score(in[k].visibility) : 0};
    }
}

/* RTMPose, by mmdeploy: points in pixels, and scores, which may be over 1. */
static void from_rtmpose(edml_keypoint out[17], const float point[17][2], const float scores[17])
{
    for (int k = 0; k < 17; k++) out[k] = (edml_keypoint){point[k][0], point[k][1], score(scores[k])};
}

/* OpenPose's array [people][25][3]: x, y, score in pixels; 0, 0, 0 was not found. */
static void from_openpose(edml_keypoint out[25], const float *array, int person)
{
    for (int k = 0; k < 25; k++) {
        const float *p = array + 3 * (25 * person + k);
        out[k] = (edml_keypoint){p[0], p[1], score(p[2])};
    }
}

static void lift(const char *detector, const edml_keypoint seen[], const edml_format *format)
{
    static edml_work work;
    edml_keypoint joints[EDML_JOINTS];
    edml_pose pose;
    edml_adapt(joints, seen, format);
    const edml_status status = edml_lift(&pose, joints, NULL, &edml_distances_w16, &work, sizeof work);
    if (status != EDML_OK) {
        printf("%-9s %s\n", detector, edml_status_name(status));
        return;
    }
    const edml_point wrist = pose.joint[EDML_R_WRIST];
    printf("%-9s right wrist at %.2f %.2f %.2f m\n", detector, wrist.x, wrist.y, wrist.z);
}

int main(void)
{
    /* One person, as COCO orders it: x, y in pixels. */
    static const float person[17][2] = {
        {250, 170}, {257, 160}, {243, 160}, {264, 163}, {231, 163}, {276, 203},
        {215, 204}, {285, 249}, {209, 248}, {278, 285}, {233, 282}, {264, 298},
        {226, 298}, {273, 356}, {221, 359}, {298, 410}, {222, 419},
    };
    static const int of_body25[17] = {0, 16, 15, 18, 17, 5, 2, 6, 3, 7, 4, 12, 9, 13, 10, 14, 11};
    static const int of_blazepose[17] = {0, 2, 5, 7, 8, 11, 12, 13, 14, 15, 16, 23, 24, 25, 26, 27, 28};
    static float movenet[17][3], yolo[56], scores[17], openpose[25 * 3];
    static landmark blazepose[33];
    edml_keypoint seen[33];
    for (int k = 0; k < 17; k++) {
        const float x = person[k][0], y = person[k][1];
        const float p[3] = {x, y, 0.9F}, m[3] = {y / HEIGHT, (x + (HEIGHT - WIDTH) / 2) / HEIGHT, 0.9F};
        memcpy(movenet[k], m, sizeof m);
        memcpy(yolo + 5 + 3 * k, p, sizeof p);
        memcpy(openpose + 3 * of_body25[k], p, sizeof p);
        blazepose[of_blazepose[k]] = (landmark){x / WIDTH, y / HEIGHT, 0, 0.9F};
        scores[k] = 0.9F;
    }
    from_movenet(seen, (const float(*)[3])movenet);
    lift("MoveNet", seen, &edml_coco17); /* the keypoints of movenet17, in pixels */
    from_yolo(seen, yolo);
    lift("YOLO-pose", seen, &edml_coco17);
    from_blazepose(seen, blazepose);
    lift("BlazePose", seen, &edml_blazepose33);
    from_rtmpose(seen, person, scores);
    lift("RTMPose", seen, &edml_coco17);
    from_openpose(seen, openpose, 0);
    lift("OpenPose", seen, &edml_body25);
    return 0;
}
