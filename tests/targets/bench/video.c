/* Instructions and stack of a frame of a video, on an emulated core: "name instructions stack", the mean and
 * the deepest over the frames.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "stages.h"

#include "measure.h"

static edml_track track;
static uint32_t time_ms;

STAGE nothing(void) {}
STAGE stage_track(void) { edml_track_lift(&out, &track, in, time_ms, NULL, &MODEL, &work, sizeof work); }

/* On one state of the track. */
static int stack_of_track(void)
{
    const edml_track before = track;
    const int deepest = stack_bytes(stage_track);
    track = before;
    return deepest;
}

int main(void)
{
    uint64_t lift = 0, frame = 0;
    int lift_stack = 0, frame_stack = 0;
    edml_track_start(&track);
    for (int i = 0; i < POSES; i++) {
        make_pose(i);
        time_ms = 33 * (uint32_t)i;
        lift += counts(stage_lift) - counts(nothing);
        const int deep = stack_bytes(stage_lift), deeper = stack_of_track();
        if (deep > lift_stack) lift_stack = deep;
        if (deeper > frame_stack) frame_stack = deeper;
        frame += counts(stage_track) - counts(nothing);
    }
    printf("lift %lu %d\n", (unsigned long)(lift * 1000 / COUNTS_PER_1000 / POSES), lift_stack);
    printf("frame %lu %d\n", (unsigned long)(frame * 1000 / COUNTS_PER_1000 / POSES), frame_stack);
    return 0;
}
