/* Video: from a stream of lifts to steady motion, a frame at a time and none delayed.
 *
 * The steps: undo swaps of right and left; filter the keypoints, and hold joints that are missing for a
 * moment; lift; choose the mirror image that persists; filter the pose.  Both filters are one-euro filters.
 * tools/evaluation measures it; the numbers below were chosen on training people.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <string.h>

#include "edmlift/video.h"

#include "../api/api_f32.h"
#include "../geometry/seen.h"
#include "../geometry/vector.h"

enum { HOLD_MS = 300, GAP_MS = 1000 }; /* ms */
enum { MIN_SEEN = EDML_JOINTS / 2 };

#define IMAGE_CUTOFF 2.0F /* Hz */
#define IMAGE_SLOPE 4.0F  /* Hz per body size per second */
#define SPACE_CUTOFF 1.0F
#define SPACE_SLOPE 2.5F /* Hz per m/s */
#define RATE_CUTOFF 4.0F /* Hz */

/* The filters act in full at a usual detector's jitter; steadier keypoints are filtered less. */
#define JITTER_FULL 0.115F  /* of a usual detector, body sizes: see estimate_jitter() ... */
#define JITTER_SECONDS 0.2F /* ... averaged over */
#define MAX_STEADINESS 3.0F /* times as steady as that: no filter gets lighter than for these */

/* Log-odds, see flips(). */
#define MAX_LOG_ODDS 6.0F      /* no belief is stronger */
#define SIDES_AT_START 2.0F    /* that the detector's sides are right at the start ... */
#define MIRROR_AT_START 2.0F   /* the same for the first mirror image */
#define SIDES_PER_SECOND 16.0F /* ... and the evidence for it that each second of detections adds */
#define SIDES_CONTINUE 0.3F    /* seconds, per squared body size */
#define MIRROR_CONTINUES 0.15F /* seconds per square metre */
#define MIRROR_PER_FRAME 5.0F  /* evidence for the mirror image that a single frame gives */

/* ---- The one-euro filter (Casiez, Roussel, Vogel 2012) ---------------------------------------- */

static edml_moving at_rest(edml_point at)
{
    const edml_moving state = {at, {0, 0, 0}};
    return state;
}

/* The low-pass gain for a sample that comes `seconds` after the last. */
static float gain(float cutoff, float seconds) { return seconds / (seconds + 1 / (6.2831853F * cutoff)); }

/* Moves a joint towards where it is seen.  All of its coordinates have one cutoff, by its speed in units per
 * second, so that a rotation of the camera changes nothing. */
static void smooth(edml_moving *joint, edml_point seen, float seconds, edml_smoothing by, float unit)
{
    const edml_point step = minus(seen, joint->at);
    const edml_point news = minus(times(1 / seconds, step), joint->rate);
    joint->rate = plus(joint->rate, times(gain(RATE_CUTOFF, seconds), news));
    const float x = joint->rate.x / unit, y = joint->rate.y / unit, z = joint->rate.z / unit;
    const float cutoff = by.cutoff + by.slope * sqrtf(x * x + y * y + z * z);
    joint->at = plus(joint->at, times(gain(cutoff, seconds), step));
}

/* The filter for keypoints as steady as these.  The fourth power tells a detector's noise from motion, of
 * which estimate_jitter() sees a fifth as much. */
static edml_smoothing lighten(edml_smoothing by, const edml_track *track)
{
    if (!(track->jitter < track->jitter_full)) return by;
    const int most = MAX_STEADINESS * track->jitter <= track->jitter_full; /* jitter is 0 if nobody moves */
    const float part = most ? MAX_STEADINESS : track->jitter_full / track->jitter;
    const float power = part * part * part * part;
    by.cutoff *= power;
    by.slope *= power;
    return by;
}

/* ---- Right or reflected -------------------------------------------------------------------------- */

static float clamp_float(float value, float most) /* NaN -> 0 */
{
    if (value > most) return most;
    if (value < -most) return -most;
    return value == value ? value : 0;
}

/* A choice between two: a pose or its mirror image; limbs as detected, or right and left swapped.
 *   belief      log-odds that the choices returned so far were right; updated
 *   evidence    log-odds of the choice that this frame alone speaks for
 *   continuity  log-odds that this choice continues the past; negative if the other one does
 * Returns whether the past choices must be flipped. */
static int flips(float *belief, float continuity, float evidence)
{
    const float link = clamp_float(continuity, MAX_LOG_ODDS);
    const float carried = clamp_float(*belief, fabsf(link)); /* a chain is no stronger than its link */
    const float now = clamp_float(carried + (link < 0 ? -evidence : evidence), MAX_LOG_ODDS);
    *belief = fabsf(now);
    return now < 0;
}

/* ---- Right and left ------------------------------------------------------------------------------ */

/* Was it seen lately? */
static int is_known(const edml_track *track, int j) { return track->joint[j].age <= HOLD_MS; }

/* The mean |x| + |y| of the seen joints from their mean. */
static float body_size(const edml_keypoint in[])
{
    const float count = (float)count_seen(seen_joints(in));
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

/* Where the joints that were seen lately are expected `ms` after the last frame. */
static void expect_joints(edml_keypoint expected[], const edml_track *track, uint32_t ms)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_tracked_joint *joint = &track->joint[j];
        const float seconds = 0.001F * (float)(joint->age + ms);
        const edml_point at = plus(joint->image.at, times(seconds, joint->image.rate));
        expected[j].x = at.x;
        expected[j].y = at.y;
        expected[j].c = is_known(track, j) ? 1 : 0;
    }
}

static float between(edml_keypoint a, edml_keypoint b) { return HYPOT(a.x - b.x, a.y - b.y); }

/* How far a joint is from where it is expected; or from where the joint of the other side is, if that brings
 * both of them nearer: the detector may have swapped them. */
static float joint_distance(const edml_keypoint in[], const edml_keypoint expected[], int j)
{
    const int k = edml_mirror_joint[j];
    const float straight = between(in[j], expected[j]);
    if (!(in[k].c > 0 && expected[k].c > 0)) return straight;
    const float swapped = between(in[j], expected[k]);
    return swapped + between(in[k], expected[j]) < straight + between(in[k], expected[k]) ? swapped
                                                                                          : straight;
}

/* The median distance of the joints that are seen, and were seen lately: one or two may be far off.  In body
 * sizes, the smaller of the two.  HUGE_VALF: there are none, or no number. */
static float frame_distance(const edml_track *track, const edml_keypoint in[], uint32_t ms)
{
    edml_keypoint expected[EDML_JOINTS];
    float sorted[EDML_JOINTS];
    int count = 0;
    expect_joints(expected, track, ms);
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(in[j].c > 0 && expected[j].c > 0)) continue;
        const float distance = joint_distance(in, expected, j);
        int n = count++;
        for (; n > 0 && !(distance >= sorted[n - 1]); n--) sorted[n] = sorted[n - 1];
        sorted[n] = distance;
    }
    if (count == 0) return HUGE_VALF;
    const float is = body_size(in), was = body_size(expected);
    const float distance = sorted[count / 2] / (is < was ? is : was);
    return distance <= FLT_MAX ? distance : HUGE_VALF;
}

/* How much farther from where they are expected three right joints and their left ones would be if they were
 * swapped, in squares.  That is twice the product of right minus left, expected and now. */
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

static void swap_past(edml_track *track, int right)
{
    for (int r = right; r < right + 3; r++) {
        const int l = edml_mirror_joint[r];
        const edml_tracked_joint right_one = track->joint[r];
        track->joint[r] = track->joint[l];
        track->joint[l] = right_one;
    }
}

static void swap_keypoints(edml_keypoint in[], int right)
{
    for (int r = right; r < right + 3; r++) {
        const edml_keypoint other = in[r];
        in[r] = in[edml_mirror_joint[r]];
        in[edml_mirror_joint[r]] = other;
    }
}

/* Undoes a swap of three right joints with their left ones; returns whether there was one. */
static int unswap_sides(edml_track *track, edml_keypoint in[], int right, float *belief, float size)
{
    const float seconds = 0.001F * (float)track->elapsed;
    float continuity = SIDES_CONTINUE / seconds * side_continuity(track, in, right, size);
    if (flips(belief, continuity, SIDES_PER_SECOND * seconds)) {
        swap_past(track, right);
        continuity = -continuity;
    }
    if (!(continuity < 0)) return 0;
    swap_keypoints(in, right);
    return 1;
}

/* ---- The image ------------------------------------------------------------------------------------ */

/* Estimates the keypoints' jitter: the change of the prediction error from frame to frame.  Motion that is
 * faster than predicted stays so for some frames; noise does not. */
static void estimate_jitter(edml_track *track, const edml_keypoint in[], float size)
{
    float sum = 0, count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        edml_tracked_joint *joint = &track->joint[j];
        if (!(in[j].c > 0 && is_known(track, j))) continue;
        const float seconds = 0.001F * (float)(joint->age + track->elapsed);
        const edml_point expected = plus(joint->image.at, times(seconds, joint->image.rate));
        const float x = (in[j].x - expected.x) / size, y = (in[j].y - expected.y) / size;
        const float more_x = x - joint->innovation_x, more_y = y - joint->innovation_y;
        joint->innovation_x = x;
        joint->innovation_y = y;
        sum += sqrtf((more_x * more_x + more_y * more_y) / 2); /* both errors have the noise */
        count++;
    }
    if (!(count > 0)) return;
    const float seconds = 0.001F * (float)track->elapsed;
    const float off = clamp_float(sum / count, 1); /* infinity would stay for ever */
    track->jitter += seconds / (seconds + JITTER_SECONDS) * (off - track->jitter);
}

/* Smooths the seen joints; returns their mean motion. */
static edml_point smooth_seen(edml_track *track, edml_keypoint in[], float size)
{
    const edml_smoothing by = lighten(track->smooth_image, track);
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
            joint->innovation_x = joint->innovation_y = 0;
        }
        joint->age = 0;
        in[j].x = joint->image.at.x;
        in[j].y = joint->image.at.y;
    }
    return count > 0 ? times(1 / count, moved) : moved;
}

/* Holds joints that were seen lately where they were, moved along with the others. */
static uint16_t hold_missing(edml_track *track, edml_keypoint in[], edml_point moved)
{
    uint16_t held = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (in[j].c > 0) continue;
        const uint32_t age = track->joint[j].age + track->elapsed;
        track->joint[j].age = (uint16_t)(age <= HOLD_MS ? age : HOLD_MS + 1);
        if (!is_known(track, j)) continue;
        track->joint[j].image.at = plus(track->joint[j].image.at, moved);
        in[j].x = track->joint[j].image.at.x;
        in[j].y = track->joint[j].image.at.y;
        in[j].c = 1;
        held = (uint16_t)(held | 1U << j);
    }
    return held;
}

static void smooth_image(edml_track *track, edml_keypoint in[], float size)
{
    track->swapped = 0;
    if (track->elapsed > 0) {
        if (unswap_sides(track, in, EDML_R_SHOULDER, &track->arms_log_odds, size))
            track->swapped |= EDML_SWAPPED_ARMS;
        if (unswap_sides(track, in, EDML_R_HIP, &track->legs_log_odds, size))
            track->swapped |= EDML_SWAPPED_LEGS;
    }
    estimate_jitter(track, in, size);
    const edml_point moved = smooth_seen(track, in, size);
    track->held = hold_missing(track, in, moved);
}

/* ---- Space ---------------------------------------------------------------------------------------- */

/* Takes the mirror image that persists.  In the camera's axes it has depths negated, but for the centimetre
 * or two of perspective that lift/fuse.h took out by the other depths.  The squared distances of the two from
 * the last pose differ by four times the product of the depths. */
static int choose_mirror(edml_track *track, edml_pose *out)
{
    float continuity = 0;
    for (int j = 0; j < EDML_JOINTS; j++) continuity += 4 * out->joint[j].z * track->joint[j].space.at.z;
    continuity *= MIRROR_CONTINUES / (0.001F * (float)track->elapsed);
    if (flips(&track->mirror_log_odds, continuity, MIRROR_PER_FRAME)) {
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

static void smooth_pose(edml_track *track, edml_pose *out)
{
    const edml_smoothing by = lighten(track->smooth_space, track);
    const int first = track->elapsed == 0;
    const float seconds = 0.001F * (float)track->elapsed;
    if (first) track->mirror_log_odds = MIRROR_AT_START;
    track->mirrored = (uint8_t)(first ? 0 : choose_mirror(track, out));
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
    track->jitter_full = JITTER_FULL;
}

/* Moves on to a frame.  The first one, and one after a gap, have no past. */
static void move_on(edml_track *track, uint32_t time_ms)
{
    track->elapsed = track->started ? time_ms - track->time : 0;
    track->time = time_ms;
    track->started = 1;
    if (track->elapsed > 0 && track->elapsed <= GAP_MS) return;
    track->elapsed = 0;
    track->arms_log_odds = track->legs_log_odds = SIDES_AT_START;
    track->jitter = track->jitter_full / 2; /* until it is known */
    for (int j = 0; j < EDML_JOINTS; j++) track->joint[j].age = HOLD_MS + 1;
}

float edml_track_distance(const edml_track *track, const edml_keypoint in[EDML_JOINTS], uint32_t time_ms)
{
    if (track == NULL || in == NULL || !track->started) return HUGE_VALF;
    const uint32_t ms = time_ms - track->time;
    if (ms == 0 || ms > GAP_MS || !are_finite(in, seen_joints(in))) return HUGE_VALF;
    return frame_distance(track, in, ms);
}

static int is_usable(edml_smoothing by) { return by.cutoff > 0 && by.slope >= 0 && by.slope <= FLT_MAX; }

void edml_track_swap_sides(edml_keypoint in[EDML_JOINTS], const edml_track *track)
{
    if (track->swapped & EDML_SWAPPED_ARMS) swap_keypoints(in, EDML_R_SHOULDER);
    if (track->swapped & EDML_SWAPPED_LEGS) swap_keypoints(in, EDML_R_HIP);
}

edml_status edml_track_lift(edml_pose *out, edml_track *track, const edml_keypoint in[EDML_JOINTS],
                            uint32_t time_ms, const edml_point *up, const edml_model *model, void *work,
                            size_t work_bytes)
{
    if (out == NULL || track == NULL || in == NULL || model == NULL || work == NULL)
        return EDML_ERR_ARGUMENT;
    if (!is_usable(track->smooth_image) || !is_usable(track->smooth_space) || !(track->jitter_full >= 0))
        return EDML_ERR_ARGUMENT;
    const uint32_t later = time_ms - track->time; /* also across the end of the clock's range */
    if (track->started && (later == 0 || later > UINT32_MAX / 2)) return EDML_ERR_TIME;
    const uint16_t seen = seen_joints(in);
    if (!are_finite(in, seen)) return EDML_ERR_NOT_FINITE;
    if (count_seen(seen) < MIN_SEEN) return EDML_ERR_TOO_FEW_JOINTS;
    const float size = body_size(in);
    if (!(size > 0)) return EDML_ERR_DEGENERATE;

    edml_track next = *track; /* takes effect only if the frame is lifted */
    edml_keypoint joints[EDML_JOINTS];
    memcpy(joints, in, sizeof joints);
    move_on(&next, time_ms);
    smooth_image(&next, joints, size);
    const edml_status status = edml_lift(out, joints, up, model, work, work_bytes);
    if (status != EDML_OK) return status;
    out->seen = (uint16_t)(out->seen & ~next.held);
    smooth_pose(&next, out);
    *track = next;
    return EDML_OK;
}
