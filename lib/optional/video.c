/* Video: from a stream of lifts to steady motion, a frame at a time and none delayed.
 *
 * The steps: is it the same person; undo swaps of right and left; filter the keypoints, and hold joints that
 * are missing for a moment; lift; choose the mirror image that persists; filter the pose.  Both filters are
 * one-euro filters that let pass what is no noise.
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

enum { HOLD_MS = 300, GAP_MS = 1000, LEAP_MS = 100 };
enum { MIN_SEEN = EDML_JOINTS / 2 };

/* Another person is farther away than this, in body sizes; frames apart need more. */
#define LEAP 1.0F
#define LEAP_PER_SECOND 2.0F

#define IMAGE_CUTOFF 2.0F /* Hz */
#define IMAGE_SLOPE 4.0F  /* Hz per body size per second */
#define SPACE_CUTOFF 2.0F
#define SPACE_SLOPE 2.5F     /* Hz per m/s */
#define RATE_CUTOFF 4.0F     /* Hz */
#define NOISE_FULL 1.0F      /* see motion_share() */
#define MEAN_SECONDS 0.2F    /* what jitter and steps are averaged over */
#define NOISE_IN_JITTER 1.0F /* mean square length of noise, by the square of the jitter that it makes */

/* Log-odds, see flips(). */
#define MAX_LOG_ODDS 6.0F      /* no belief is stronger */
#define SIDES_AT_START 2.0F    /* that the detector's sides are right at the start ... */
#define MIRROR_AT_START 2.0F   /* the same for the first mirror image */
#define SIDES_PER_SECOND 11.7F /* ... and the evidence for it that each second of detections adds */
#define SIDES_CONTINUE 0.3F    /* seconds, per squared body size */
#define MIRROR_CONTINUES 0.15F /* seconds per square metre */
#define MIRROR_PER_FRAME 5.0F  /* evidence for the mirror image that a single frame gives */

static float clamp_float(float value, float most) /* NaN -> 0 */
{
    if (value > most) return most;
    if (value < -most) return -most;
    return value == value ? value : 0;
}

/* ---- The one-euro filter (Casiez, Roussel, Vogel 2012) ---------------------------------------- */

static edml_moving at_rest(edml_point at)
{
    const edml_moving state = {at, {0, 0, 0}};
    return state;
}

/* The low-pass gain for a sample that comes `seconds` after the last. */
static float gain(float cutoff, float seconds) { return seconds / (seconds + 1 / (6.2831853F * cutoff)); }

/* Both filters, for a frame. */
typedef struct {
    edml_smoothing by;
    float unit;   /* of speed */
    float motion; /* the least gain: this part of what is new is motion */
    float noise;  /* mean square of the other part, squared units */
} filter;

/* The part of the keypoints' steps that is motion.  Motion goes on in the next frame, and noise does not:
 * exact keypoints have a jitter of a third of their steps, noise alone one of 1.4 times.  Neither depends on
 * how large the steps are; what is small in the image may be large in depth. */
static float motion_share(const edml_track *track)
{
    const float full = track->noise_full * track->image_step;
    if (!(track->jitter < full)) return 0; /* also where nothing moves */
    const float part = track->jitter / full;
    return 1 - part * part * part * part;
}

/* `step` is the mean one in the filter's own units. */
static filter filter_by(edml_smoothing by, const edml_track *track, float step, float unit)
{
    filter made = {by, unit, motion_share(track), 0};
    if (!(track->noise_full > 0 && track->image_step > 0)) return made;
    const float jitter = track->jitter * (step / track->image_step);
    made.noise = NOISE_IN_JITTER * jitter * jitter;
    return made;
}

/* Moves a joint towards where it is seen.  All of its coordinates have one cutoff, by its speed in units per
 * second, so that a rotation of the camera changes nothing.  Noise has a speed as well, which is taken off. */
static void smooth(edml_moving *joint, edml_point seen, float seconds, const filter *f)
{
    const edml_point step = minus(seen, joint->at);
    const edml_point news = minus(times(1 / seconds, step), joint->rate);
    const float rate_gain = gain(RATE_CUTOFF, seconds);
    joint->rate = plus(joint->rate, times(rate_gain, news));
    const float x = joint->rate.x / f->unit, y = joint->rate.y / f->unit, z = joint->rate.z / f->unit;
    const float of_noise = rate_gain / (2 - rate_gain) * f->noise / (seconds * seconds);
    const float square = x * x + y * y + z * z - of_noise;
    const float cutoff = f->by.cutoff + f->by.slope * sqrtf(square > 0 ? square : 0);
    const float alone = gain(cutoff, seconds);
    joint->at = plus(joint->at, times(alone > f->motion ? alone : f->motion, step));
}

/* A mean over MEAN_SECONDS. */
static void average(float *mean, float value, float seconds)
{
    *mean += seconds / (seconds + MEAN_SECONDS) * (clamp_float(value, 1) - *mean); /* infinity would stay */
}

/* ---- Right or reflected -------------------------------------------------------------------------- */

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

/* Estimates how far keypoints are from the filtered ones, and their jitter: the change of the prediction
 * error from frame to frame.  Motion that is faster than predicted stays so for some frames; noise does not. */
static void estimate_jitter(edml_track *track, const edml_keypoint in[], float size)
{
    float jitter = 0, steps = 0, count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        edml_tracked_joint *joint = &track->joint[j];
        if (!(in[j].c > 0 && is_known(track, j))) continue;
        const float seconds = 0.001F * (float)(joint->age + track->elapsed);
        const edml_point seen = {in[j].x, in[j].y, 0}, step = minus(seen, joint->image.at);
        const edml_point error = minus(step, times(seconds, joint->image.rate));
        const float x = error.x / size, y = error.y / size;
        const float more_x = x - joint->innovation_x, more_y = y - joint->innovation_y;
        joint->innovation_x = x;
        joint->innovation_y = y;
        jitter += sqrtf((more_x * more_x + more_y * more_y) / 2); /* both errors have the noise */
        steps += HYPOT(step.x / size, step.y / size);
        count++;
    }
    if (!(count > 0)) return;
    const float seconds = 0.001F * (float)track->elapsed;
    average(&track->jitter, jitter / count, seconds);
    average(&track->image_step, steps / count, seconds);
}

/* Smooths the seen joints; returns their mean motion. */
static edml_point smooth_seen(edml_track *track, edml_keypoint in[], float size)
{
    const filter by = filter_by(track->smooth_image, track, track->image_step, size);
    edml_point moved = {0, 0, 0};
    float count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        edml_tracked_joint *joint = &track->joint[j];
        const edml_point seen = {in[j].x, in[j].y, 0}, before = joint->image.at;
        if (!(in[j].c > 0)) continue;
        if (is_known(track, j)) {
            const float seconds = 0.001F * (float)(joint->age + track->elapsed);
            smooth(&joint->image, seen, seconds, &by);
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

static void smooth_image(edml_track *track, edml_keypoint in[])
{
    track->swapped = 0;
    if (track->elapsed > 0) {
        const float size = body_size(in);
        if (unswap_sides(track, in, EDML_R_SHOULDER, &track->arms_log_odds, size))
            track->swapped |= EDML_SWAPPED_ARMS;
        if (unswap_sides(track, in, EDML_R_HIP, &track->legs_log_odds, size))
            track->swapped |= EDML_SWAPPED_LEGS;
    }
    const float size = body_size(in); /* to the bit as without a swap */
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

/* The mean distance of the joints from the filtered ones, metres. */
static float mean_step(const edml_track *track, const edml_pose *out)
{
    float sum = 0;
    for (int j = 0; j < EDML_JOINTS; j++) sum += norm(minus(out->joint[j], track->joint[j].space.at));
    return sum / EDML_JOINTS;
}

static void smooth_pose(edml_track *track, edml_pose *out)
{
    const int first = track->elapsed == 0;
    const float seconds = 0.001F * (float)track->elapsed;
    if (first) track->mirror_log_odds = MIRROR_AT_START;
    track->mirrored = (uint8_t)(first ? 0 : choose_mirror(track, out));
    if (!first) average(&track->space_step, mean_step(track, out), seconds);
    const filter by = filter_by(track->smooth_space, track, track->space_step, 1);
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (first)
            track->joint[j].space = at_rest(out->joint[j]);
        else
            smooth(&track->joint[j].space, out->joint[j], seconds, &by);
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
    track->noise_full = NOISE_FULL;
}

/* Starts anew, with a frame that has no past. */
static void forget(edml_track *track)
{
    track->elapsed = 0;
    track->arms_log_odds = track->legs_log_odds = SIDES_AT_START;
    track->jitter = track->image_step = track->space_step = 0;
    for (int j = 0; j < EDML_JOINTS; j++) track->joint[j].age = HOLD_MS + 1;
}

/* Moves on to a frame.  The first one, and one after a gap, have no past.  Nor has another person, who may be
 * there for a moment; then the past waits. */
static void move_on(edml_track *track, const edml_keypoint in[], uint32_t time_ms)
{
    track->elapsed = track->started ? time_ms - track->time + track->aside : 0;
    track->time = time_ms;
    track->started = 1;
    track->leapt = 0;
    track->aside = 0;
    if (track->elapsed > 0 && track->elapsed <= GAP_MS) {
        const float most = LEAP + LEAP_PER_SECOND * 0.001F * (float)track->elapsed;
        if (frame_distance(track, in, track->elapsed) <= most) return;
        track->leapt = 1;
        if (track->elapsed <= LEAP_MS) {
            track->aside = (uint16_t)track->elapsed;
            return;
        }
    }
    forget(track);
}

float edml_track_distance(const edml_track *track, const edml_keypoint in[EDML_JOINTS], uint32_t time_ms)
{
    if (track == NULL || in == NULL || !track->started) return HUGE_VALF;
    const uint32_t later = time_ms - track->time, ms = later + track->aside;
    if (later == 0 || later > GAP_MS || ms > GAP_MS || !are_finite(in, seen_joints(in))) return HUGE_VALF;
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
    if (!is_usable(track->smooth_image) || !is_usable(track->smooth_space) ||
        !(track->noise_full >= 0 && track->noise_full <= FLT_MAX))
        return EDML_ERR_ARGUMENT;
    const uint32_t later = time_ms - track->time; /* also across the end of the clock's range */
    if (track->started && (later == 0 || later > UINT32_MAX / 2)) return EDML_ERR_TIME;
    const uint16_t seen = seen_joints(in);
    if (!are_finite(in, seen)) return EDML_ERR_NOT_FINITE;
    if (count_seen(seen) < MIN_SEEN) return EDML_ERR_TOO_FEW_JOINTS;
    if (!(body_size(in) > 0)) return EDML_ERR_DEGENERATE;

    edml_track next = *track; /* takes effect only if the frame is lifted */
    edml_keypoint joints[EDML_JOINTS];
    memcpy(joints, in, sizeof joints);
    move_on(&next, in, time_ms);
    if (next.aside == 0) smooth_image(&next, joints);
    const edml_status status = edml_lift(out, joints, up, model, work, work_bytes);
    if (status != EDML_OK) return status;
    if (next.aside > 0) {
        next.elapsed = next.held = next.swapped = next.mirrored = 0;
    } else {
        out->seen = (uint16_t)(out->seen & ~next.held);
        smooth_pose(&next, out);
    }
    *track = next;
    return EDML_OK;
}
