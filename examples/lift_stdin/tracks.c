/* A track for each person of a video.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>

#include "lift_stdin.h"

enum { TRACKS = 16 };
#define LONGEST_GAP_MS 1000.0
#define REACH 1.0F /* body sizes from where a track expects a person; beyond is another one */

static person_track tracks[TRACKS];
static long numbers; /* given so far */

uint32_t clock_of(double ms) { return (uint32_t)fmod(floor(ms), 4294967296.0); }

static void start_track(person_track *by, const options *set)
{
    edml_track *track = &by->track;
    start_fixed_track(&by->fixed.track, set);
    edml_track_start(track);
    if (set->smooth_image.cutoff > 0) track->smooth_image = set->smooth_image;
    if (set->smooth_space.cutoff > 0) track->smooth_space = set->smooth_space;
    if (set->noise_full >= 0) track->noise_full = set->noise_full;
}

/* Who is alone has a track that never ends. */
static person_track *track_of_one(const options *set)
{
    static person_track one;
    if (!one.alone) start_track(&one, set);
    one.alone = 1;
    one.number = -1;
    return &one;
}

static void end_tracks(double ms)
{
    for (int n = 0; n < TRACKS; n++)
        if (ms - tracks[n].last_ms > LONGEST_GAP_MS) tracks[n].in_use = 0;
}

static person_track *new_track(uint64_t id, double ms, const options *set)
{
    for (int n = 0; n < TRACKS; n++) {
        if (tracks[n].in_use) continue;
        tracks[n].in_use = 1;
        start_track(&tracks[n], set);
        tracks[n].id = id;
        tracks[n].number = -1;
        tracks[n].last_ms = ms;
        return &tracks[n];
    }
    return NULL;
}

/* By its id or, of those without one, the nearest that had no frame at this time. */
static person_track *old_track(const person *who, const edml_keypoint joints[], double ms, int fixed)
{
    person_track *nearest = NULL;
    float least = REACH;
    for (int n = 0; n < TRACKS; n++) {
        if (!tracks[n].in_use || tracks[n].id != who->id) continue;
        if (who->id != 0) return &tracks[n];
        const float distance = fixed ? distance_fixed(&tracks[n].fixed.track, joints, ms)
                                     : edml_track_distance(&tracks[n].track, joints, clock_of(ms));
        if (!(distance <= least)) continue;
        least = distance;
        nearest = &tracks[n];
    }
    return nearest;
}

person_track *find_track(const person *who, const edml_keypoint joints[EDML_JOINTS], double ms,
                         const options *set)
{
    if (!who->listed && who->id == 0) return track_of_one(set);
    end_tracks(ms);
    person_track *found = old_track(who, joints, ms, set->fixed);
    return found != NULL ? found : new_track(who->id, ms, set);
}

void feed_track(person_track *track, double ms, int lifted)
{
    if (track->alone) return;
    if (track->number < 0 && lifted) track->number = numbers++;
    track->in_use = track->number >= 0;
    track->last_ms = ms;
}
