/* Video: from a stream of lifts to steady motion, a frame at a time and none delayed.
 *
 * Right and left, where the detector exchanged them; a one-euro filter on the keypoints, and joints
 * that are missing for a moment; the lift; the mirror image that persists; a one-euro filter on the
 * pose.  tools/evaluate_video.py measures it; the numbers below were chosen by it on training people.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <string.h>

#include "real_f32.h"

#include "seen.inc"

enum { HOLD = 300, GAP = 1000 }; /* ms */
enum { FEWEST_SEEN = EDML_JOINTS / 2 };

#define IMAGE_CUTOFF 2.0F /* Hz */
#define IMAGE_SLOPE 4.0F  /* Hz per size of the body a second */
#define SPACE_CUTOFF 1.0F
#define SPACE_SLOPE 2.5F /* Hz per m/s */
#define RATE_CUTOFF 4.0F /* Hz */

/* Filters of keypoints as steady as a usual detector's; steadier ones want less of them. */
#define NOISE 0.115F       /* how much those jump, see watch_steadiness(), in body sizes ... */
#define NOISE_SECONDS 0.2F /* ... averaged over */
#define STEADIEST 3.0F     /* times as steady: no filter gets lighter than of these */

/* Log-odds of twins, see turns_over(). */
#define SUREST 6.0F            /* nothing is believed more than this */
#define LABELS 2.0F            /* that right and left are right at the start ... */
#define LABELS_A_SECOND 16.0F  /* ... and how fast a detector persuades that they are after all */
#define LABELS_CONTINUE 0.3F   /* seconds; of squares of the body's size */
#define MIRROR_CONTINUES 0.15F /* seconds a square metre */

/* ---- The one-euro filter (Casiez, Roussel, Vogel 2012) ---------------------------------------- */

static edml_point plus(edml_point a, edml_point b)
{
    const edml_point sum = {a.x + b.x, a.y + b.y, a.z + b.z};
    return sum;
}

static edml_point minus(edml_point a, edml_point b)
{
    const edml_point difference = {a.x - b.x, a.y - b.y, a.z - b.z};
    return difference;
}

static edml_point times(float scale, edml_point a)
{
    const edml_point product = {scale * a.x, scale * a.y, scale * a.z};
    return product;
}

static edml_moving at_rest(edml_point at)
{
    const edml_moving state = {at, {0, 0, 0}};
    return state;
}

/* Share of the way to a sample that comes `seconds` after the last. */
static float share(float cutoff, float seconds)
{
    return seconds / (seconds + 1 / (6.2831853F * cutoff));
}

/* Moves a joint towards where it is seen.  One cutoff for all of its coordinates, by its speed in
 * units a second: so turning the camera changes nothing. */
static void smooth(edml_moving *joint, edml_point seen, float seconds, edml_smoothing by, float unit)
{
    const edml_point step = minus(seen, joint->at);
    const edml_point news = minus(times(1 / seconds, step), joint->rate);
    joint->rate = plus(joint->rate, times(share(RATE_CUTOFF, seconds), news));
    const float x = joint->rate.x / unit, y = joint->rate.y / unit, z = joint->rate.z / unit;
    const float cutoff = by.cutoff + by.slope * sqrtf(x * x + y * y + z * z);
    joint->at = plus(joint->at, times(share(cutoff, seconds), step));
}

/* The filter that keypoints as steady as these want.  The fourth power tells a detector's noise from
 * motion, of which watch_steadiness() sees a fifth as much. */
static edml_smoothing lightened(edml_smoothing by, const edml_track *track)
{
    if (!(track->unsteady < track->noise)) return by;
    const int most = STEADIEST * track->unsteady <= track->noise; /* of nobody who moves, 0 */
    const float part = most ? STEADIEST : track->noise / track->unsteady;
    const float power = part * part * part * part;
    by.cutoff *= power;
    by.slope *= power;
    return by;
}

/* ---- Twins -------------------------------------------------------------------------------------- */

static float limit(float value, float most) /* of no number, 0 */
{
    if (value > most) return most;
    if (value < -most) return -most;
    return value == value ? value : 0;
}

/* A pose has a twin, its mirror image, and limbs have one, right and left exchanged.  What was given
 * out so far was the right twin by the log-odds `belief`.  The twin of the new frame that this frame
 * alone speaks for, by `evidence`, continues it by the log-odds `continuity`; if these are negative,
 * the other one does.  Updates the belief; returns whether to give up what was for its twin. */
static int turns_over(float *belief, float continuity, float evidence)
{
    const float link = limit(continuity, SUREST);
    const float carried = limit(*belief, fabsf(link)); /* a chain is no surer than its link */
    const float now = limit(carried + (link < 0 ? -evidence : evidence), SUREST);
    *belief = fabsf(now);
    return now < 0;
}

/* ---- Right and left ------------------------------------------------------------------------------ */

/* Was it seen lately? */
static int is_known(const edml_track *track, int j) { return track->joint[j].age <= HOLD; }

/* Mean distance along x and along y, added, of the seen joints from their middle. */
static float body_size(const edml_keypoint in[])
{
    const float count = (float)count_bits(seen_joints(in));
    float x = 0, y = 0, size = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(in[j].c > 0)) continue;
        x += in[j].x / count;
        y += in[j].y / count;
    }
    for (int j = 0; j < EDML_JOINTS; j++)
        if (in[j].c > 0) size += (fabsf(in[j].x - x) + fabsf(in[j].y - y)) / count;
    return size;
}

/* How much farther three joints and their twins would be, right and left exchanged, from where they
 * are expected; in squares.  That is twice the product of right minus left, expected and now. */
static float side_continuity(const edml_track *track, const edml_keypoint in[], int right, float size)
{
    const float seconds = 0.001F * (float)track->elapsed;
    float sum = 0;
    for (int r = right; r < right + 3; r++) {
        const int l = edml_mirror_joint[r];
        if (!(in[r].c > 0 && in[l].c > 0 && is_known(track, r) && is_known(track, l))) continue;
        const edml_point was = minus(track->joint[r].image.at, track->joint[l].image.at);
        const edml_point rate = minus(track->joint[r].image.rate, track->joint[l].image.rate);
        const edml_point expected = plus(was, times(seconds, rate));
        sum += 2 * ((in[r].x - in[l].x) / size) * (expected.x / size);
        sum += 2 * ((in[r].y - in[l].y) / size) * (expected.y / size);
    }
    return sum;
}

static void exchange_past(edml_track *track, int right)
{
    for (int r = right; r < right + 3; r++) {
        const int l = edml_mirror_joint[r];
        const edml_tracked_joint right_one = track->joint[r];
        track->joint[r] = track->joint[l];
        track->joint[l] = right_one;
    }
}

static void exchange(edml_keypoint in[], int right)
{
    for (int r = right; r < right + 3; r++) {
        const edml_keypoint other = in[r];
        in[r] = in[edml_mirror_joint[r]];
        in[edml_mirror_joint[r]] = other;
    }
}

/* Undoes an exchange of three joints with their twins; returns whether there was one. */
static int sort_sides(edml_track *track, edml_keypoint in[], int right, float *belief, float size)
{
    const float seconds = 0.001F * (float)track->elapsed;
    float continuity = LABELS_CONTINUE / seconds * side_continuity(track, in, right, size);
    if (turns_over(belief, continuity, LABELS_A_SECOND * seconds)) {
        exchange_past(track, right);
        continuity = -continuity;
    }
    if (!(continuity < 0)) return 0;
    exchange(in, right);
    return 1;
}

/* ---- The image ------------------------------------------------------------------------------------ */

/* Follows how noisy keypoints are.  Motion that is faster than expected stays so for some frames, noise
 * does not: it is in how much keypoints are elsewhere from what is expected than in the last frame. */
static void watch_steadiness(edml_track *track, const edml_keypoint in[], float size)
{
    float sum = 0, count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        edml_tracked_joint *joint = &track->joint[j];
        if (!(in[j].c > 0 && is_known(track, j))) continue;
        const float seconds = 0.001F * (float)(joint->age + track->elapsed);
        const edml_point expected = plus(joint->image.at, times(seconds, joint->image.rate));
        const float x = (in[j].x - expected.x) / size, y = (in[j].y - expected.y) / size;
        const float more_x = x - joint->off_x, more_y = y - joint->off_y;
        joint->off_x = x;
        joint->off_y = y;
        sum += sqrtf((more_x * more_x + more_y * more_y) / 2); /* of noise, for both have it */
        count++;
    }
    if (!(count > 0)) return;
    const float seconds = 0.001F * (float)track->elapsed;
    const float off = limit(sum / count, 1); /* infinity would stay */
    track->unsteady += seconds / (seconds + NOISE_SECONDS) * (off - track->unsteady);
}

/* Smooths the seen joints; returns how far they moved on average. */
static edml_point smooth_seen(edml_track *track, edml_keypoint in[], float size)
{
    const edml_smoothing by = lightened(track->smooth_image, track);
    edml_point moved = {0, 0, 0};
    float count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        edml_tracked_joint *joint = &track->joint[j];
        const edml_point seen = {in[j].x, in[j].y, 0}, before = joint->image.at;
        if (!(in[j].c > 0)) continue;
        if (is_known(track, j)) {
            const float seconds = 0.001F * (float)(joint->age + track->elapsed);
            smooth(&joint->image, seen, seconds, by, size);
            moved = plus(moved, minus(joint->image.at, before));
            count++;
        } else {
            joint->image = at_rest(seen);
            joint->off_x = joint->off_y = 0;
        }
        joint->age = 0;
        in[j].x = joint->image.at.x;
        in[j].y = joint->image.at.y;
    }
    return count > 0 ? times(1 / count, moved) : moved;
}

/* Joints that were seen lately are where they were, moved along with the others. */
static uint16_t hold_missing(edml_track *track, edml_keypoint in[], edml_point moved)
{
    uint16_t held = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (in[j].c > 0) continue;
        const uint32_t age = track->joint[j].age + track->elapsed;
        track->joint[j].age = (uint16_t)(age <= HOLD ? age : HOLD + 1);
        if (!is_known(track, j)) continue;
        track->joint[j].image.at = plus(track->joint[j].image.at, moved);
        in[j].x = track->joint[j].image.at.x;
        in[j].y = track->joint[j].image.at.y;
        in[j].c = 1;
        held = (uint16_t)(held | 1U << j);
    }
    return held;
}

static void steady_image(edml_track *track, edml_keypoint in[], float size)
{
    track->exchanged = 0;
    if (track->elapsed > 0) {
        if (sort_sides(track, in, EDML_R_SHOULDER, &track->arms, size))
            track->exchanged |= EDML_EXCHANGED_ARMS;
        if (sort_sides(track, in, EDML_R_HIP, &track->legs, size))
            track->exchanged |= EDML_EXCHANGED_LEGS;
    }
    watch_steadiness(track, in, size);
    const edml_point moved = smooth_seen(track, in, size);
    track->held = hold_missing(track, in, moved);
}

/* ---- Space ---------------------------------------------------------------------------------------- */

/* Takes the mirror image that persists: in the camera's axes, the one with depths negated (but for the
 * centimetre or two of perspective that blend.inc took out by the other depths).  Squared
 * distances of the two from the last pose differ by four times the product of the depths. */
static int sort_mirror(edml_track *track, edml_pose *out)
{
    float continuity = 0;
    for (int j = 0; j < EDML_JOINTS; j++) continuity += 4 * out->joint[j].z * track->joint[j].space.at.z;
    continuity *= MIRROR_CONTINUES / (0.001F * (float)track->elapsed);
    if (turns_over(&track->mirror, continuity, out->mirror_margin)) {
        for (int j = 0; j < EDML_JOINTS; j++) {
            track->joint[j].space.at.z = -track->joint[j].space.at.z;
            track->joint[j].space.rate.z = -track->joint[j].space.rate.z;
        }
        continuity = -continuity;
    }
    if (!(continuity < 0)) return 0;
    for (int j = 0; j < EDML_JOINTS; j++) out->joint[j].z = -out->joint[j].z;
    return 1;
}

static void steady_pose(edml_track *track, edml_pose *out)
{
    const edml_smoothing by = lightened(track->smooth_space, track);
    const int first = track->elapsed == 0;
    const float seconds = 0.001F * (float)track->elapsed;
    if (first) track->mirror = limit(out->mirror_margin, SUREST);
    track->mirrored = (uint8_t)(first ? 0 : sort_mirror(track, out));
    out->mirror_margin = track->mirror;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (first)
            track->joint[j].space = at_rest(out->joint[j]);
        else
            smooth(&track->joint[j].space, out->joint[j], seconds, by, 1);
        out->joint[j] = track->joint[j].space.at;
    }
}

/* ---- A frame -------------------------------------------------------------------------------------- */

void edml_track_start(edml_track *track)
{
    memset(track, 0, sizeof *track);
    track->smooth_image.cutoff = IMAGE_CUTOFF;
    track->smooth_image.slope = IMAGE_SLOPE;
    track->smooth_space.cutoff = SPACE_CUTOFF;
    track->smooth_space.slope = SPACE_SLOPE;
    track->noise = NOISE;
}

/* On to a frame: the first one, or one after a gap, has no past. */
static void move_on(edml_track *track, uint32_t time_ms)
{
    track->elapsed = track->started ? time_ms - track->time : 0;
    track->time = time_ms;
    track->started = 1;
    if (track->elapsed > 0 && track->elapsed <= GAP) return;
    track->elapsed = 0;
    track->arms = track->legs = LABELS;
    track->unsteady = track->noise / 2; /* until it is known */
    for (int j = 0; j < EDML_JOINTS; j++) track->joint[j].age = HOLD + 1;
}

static int is_usable(edml_smoothing by) { return by.cutoff > 0 && by.slope >= 0 && by.slope <= FLT_MAX; }

void edml_track_sort(edml_keypoint in[EDML_JOINTS], const edml_track *track)
{
    if (track->exchanged & EDML_EXCHANGED_ARMS) exchange(in, EDML_R_SHOULDER);
    if (track->exchanged & EDML_EXCHANGED_LEGS) exchange(in, EDML_R_HIP);
}

edml_status edml_track_lift(edml_pose *out, edml_track *track, const edml_keypoint in[EDML_JOINTS],
                            uint32_t time_ms, const edml_model *model, edml_work *work)
{
    if (out == NULL || track == NULL || in == NULL || model == NULL || work == NULL)
        return EDML_ERR_ARGUMENT;
    if (!is_usable(track->smooth_image) || !is_usable(track->smooth_space) || !(track->noise >= 0))
        return EDML_ERR_ARGUMENT;
    const uint32_t later = time_ms - track->time; /* also across the end of the clock's range */
    if (track->started && (later == 0 || later > UINT32_MAX / 2)) return EDML_ERR_TIME;
    const uint16_t seen = seen_joints(in);
    if (!all_finite(in, seen)) return EDML_ERR_NOT_FINITE;
    if (count_bits(seen) < FEWEST_SEEN) return EDML_ERR_TOO_FEW_JOINTS;
    const float size = body_size(in);
    if (!(size > 0)) return EDML_ERR_DEGENERATE;

    edml_track next = *track; /* which counts only if the frame is lifted */
    edml_keypoint joints[EDML_JOINTS];
    memcpy(joints, in, sizeof joints);
    move_on(&next, time_ms);
    steady_image(&next, joints, size);
    const edml_status status = edml_lift(out, joints, model, work);
    if (status != EDML_OK) return status;
    out->seen = (uint16_t)(out->seen & ~next.held);
    steady_pose(&next, out);
    *track = next;
    return EDML_OK;
}
