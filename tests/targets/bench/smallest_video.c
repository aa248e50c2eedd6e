/* The smallest program that lifts a video: what it links more than smallest.c is what a track takes of the
 * flash.
 *
 * SPDX-License-Identifier: MIT
 */
#include "lift.h"

static edml_track track;

int main(void)
{
    static uint32_t time_ms;
    if (!track.started) edml_track_start(&track);
    edml_track_lift(&out, &track, in, time_ms += 33, NULL, &MODEL, &work, sizeof work);
    return out.seen;
}
