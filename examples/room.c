/* A person's path through the room: a recorded walk, lifted frame by frame, with bones that keep their lengths,
 * before a camera whose focal length is not known. */
#include <stdio.h>

#include "edmlift.h"
#include "edmlift/body.h"
#include "edmlift/camera.h"
#include "edmlift/video.h"

static const int32_t walk[][3 * EDML_JOINTS] = {
    /* 30 frames a second: x, y in 1/100 pixel, confidence */
#include "firmware/walk.inc"
};
enum { FRAMES = (int)(sizeof walk / sizeof walk[0]) };

static edml_work work;
static edml_track track;         /* one of these three for each person */
static edml_measured_body bones; /* 72 bytes */
static edml_path path;           /* 32 bytes */
static edml_camera camera;       /* fx 0: not known yet */

/* The first pose says what the focal length is, as well as many would. */
static edml_status find_camera(const edml_pose *pose, const edml_keypoint in[EDML_JOINTS])
{
    edml_focal focal;
    edml_status status = edml_focal_start(&focal, 1000, 1000); /* width and height of the image */
    if (status == EDML_OK) status = edml_focal_add(&focal, pose, in, &work, sizeof work);
    return status == EDML_OK ? edml_focal_camera(&camera, &focal) : status;
}

/* Where somebody is in a frame. */
static edml_status follow(edml_placement *placement, edml_keypoint in[EDML_JOINTS], uint32_t time_ms)
{
    edml_pose pose;
    edml_status status = edml_track_lift(&pose, &track, in, time_ms, NULL, &edml_distances_w16, &work,
                                         sizeof work);
    if (status != EDML_OK) return status;
    edml_track_swap_sides(in, &track);
    if (track.elapsed == 0) { /* the track starts, perhaps with somebody else */
        edml_measure_start(&bones);
        edml_path_start(&path);
    }
    status = edml_measure_body(&bones, &pose);
    if (status == EDML_OK) status = edml_fit_body(&pose, &bones.body);
    if (status == EDML_OK && camera.fx == 0) status = find_camera(&pose, in);
    if (status == EDML_OK) status = edml_place(placement, &pose, in, &camera, &work, sizeof work);
    return status == EDML_OK ? edml_path_follow(&path, placement, time_ms) : status;
}

int main(void)
{
    edml_track_start(&track);
    for (int frame = 0; frame < FRAMES; frame++) {
        edml_keypoint in[EDML_JOINTS];
        edml_placement placement;
        for (int j = 0; j < EDML_JOINTS; j++) {
            in[j].x = (float)walk[frame][3 * j] / 100;
            in[j].y = (float)walk[frame][3 * j + 1] / 100;
            in[j].c = (float)walk[frame][3 * j + 2];
        }
        const edml_status status = follow(&placement, in, (uint32_t)frame * 1000 / 30);
        if (status != EDML_OK) {
            printf("frame %2d: %s\n", frame, edml_status_name(status));
            continue;
        }
        const edml_point hips = placement.translation;
        if (frame % 6 == 0)
            printf("frame %2d: %5.2f m right, %5.2f m down, %.2f m away\n", frame, hips.x, hips.y, hips.z);
    }
    printf("focal length: %.0f pixels\n", camera.fx);
    printf("right shin: %.0f mm\n", 1000 * bones.body.bone[9]);
    return 0;
}
