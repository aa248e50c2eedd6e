/* Video: a recorded walk, lifted frame by frame and made steady.  In three frames the detector swaps right
 * and left legs, in four it does not see a wrist; the track says what it did about them. */
#include <stdio.h>

#include "edmlift.h"
#include "edmlift/video.h"

static const int32_t walk[][3 * EDML_JOINTS] = {
    /* 30 frames a second: x, y in 1/100 pixel, confidence */
#include "firmware/walk.inc"
};
enum { FRAMES = (int)(sizeof walk / sizeof walk[0]) };

static edml_work work;
static edml_track track; /* 900 bytes; one for each person */

/* Stands where a detector would be. */
static void detect(edml_keypoint out[EDML_JOINTS], int frame)
{
    const int swaps_legs = frame >= 12 && frame < 15, misses_wrist = frame >= 24 && frame < 28;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int from = swaps_legs && j >= EDML_R_HIP ? edml_mirror_joint[j] : j;
        out[j].x = (float)walk[frame][3 * from] / 100;
        out[j].y = (float)walk[frame][3 * from + 1] / 100;
        out[j].c = misses_wrist && j == EDML_R_WRIST ? 0 : 1;
    }
}

int main(void)
{
    edml_track_start(&track);
    for (int frame = 0; frame < FRAMES; frame++) {
        edml_keypoint in[EDML_JOINTS];
        edml_pose pose;
        const uint32_t time_ms = (uint32_t)frame * 1000 / 30;
        detect(in, frame);
        edml_status status = edml_track_lift(&pose, &track, in, time_ms, NULL, &edml_distances_w16, &work,
                                             sizeof work);
        if (status != EDML_OK) { /* the track is as before; the next frame may be lifted */
            printf("frame %2d: %s\n", frame, edml_status_name(status));
            continue;
        }
        if (track.swapped & EDML_SWAPPED_LEGS) printf("frame %2d: legs swapped back\n", frame);
        if (track.held >> EDML_R_WRIST & 1)
            printf("frame %2d: right wrist held at %.2f %.2f %.2f m\n", frame, pose.joint[EDML_R_WRIST].x,
                   pose.joint[EDML_R_WRIST].y, pose.joint[EDML_R_WRIST].z);
    }
    printf("%d frames\n", FRAMES);
    return 0;
}
