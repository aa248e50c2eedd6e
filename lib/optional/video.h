/* Video: from a stream of lifts to steady motion, a frame at a time and none delayed.
 *
 * The steps: is it the same person; undo swaps of right and left; filter the keypoints, and hold joints that
 * are missing for a moment; lift; choose the mirror image that persists; filter the pose.  Both filters are
 * one-euro filters that let pass what is no noise.
 *
 * In the image a point's x and y are pixels, Q16 in fixed point, and rates pixels per second; in space all are
 * metres.  Pixels are within 2^29, and so are differences of two within 2^30.
 * tools/evaluation measures it; the numbers below were chosen on training people.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_VIDEO_TEXT_H
#define EDML_VIDEO_TEXT_H

#include <string.h>

#include "../api/pose.h"
#include "../geometry/seen.h"
#include "../geometry/vector.h"

enum { HOLD_MS = 300, GAP_MS = 1000, LEAP_MS = 100 };
enum { MIN_SEEN = EDML_JOINTS / 2 };
enum { FAR = 64, LIMB = 3, NOISY = 4 }; /* the most that unit_ratio() gives, see there */

/* Another person is farther away than this, in body sizes; frames apart need more. */
#define ANOTHER_PERSON REAL(1.0)
#define ANOTHER_PER_SECOND REAL(2.0)

/* Frequencies: Q16 in fixed point. */
#define HERTZ(n) PIXELS(n)
#define UNFILTERED HERTZ(2048) /* cutoffs from here on */
#define IMAGE_CUTOFF TO_API(REAL(2.0))
#define IMAGE_SLOPE TO_API(REAL(4.0)) /* Hz per body size per second */
#define SPACE_CUTOFF TO_API(REAL(2.0))
#define SPACE_SLOPE TO_API(REAL(2.5)) /* Hz per m/s */
#define RATE_CUTOFF HERTZ(4)
#define NOISE_FULL TO_API(REAL(1.0)) /* see filter_by() */
#define MAX_NOISE_FULL TO_API(REAL(64.0))
#define MEAN_SECONDS REAL(0.2) /* what jitter and steps are averaged over */

/* Log-odds, see flips(). */
#define MAX_LOG_ODDS REAL(6.0)      /* no belief is stronger */
#define SIDES_AT_START REAL(2.0)    /* that the detector's sides are right at the start ... */
#define MIRROR_AT_START REAL(2.0)   /* the same for the first mirror image */
#define SIDES_PER_SECOND REAL(11.7) /* ... and the evidence for it that each second of detections adds */
#define SIDES_CONTINUE REAL(0.3)    /* seconds, per squared body size */
#define MIRROR_CONTINUES REAL(0.15) /* seconds per square metre */
#define MIRROR_PER_FRAME REAL(5.0)  /* evidence for the mirror image that a single frame gives */

/* ---- Numbers -------------------------------------------------------------------------------------- */

static real within(real value, real most) /* NaN -> 0 */
{
    if (!(value <= most)) return value > most ? most : 0;
    return value < -most ? -most : value;
}

/* a / unit for any two like numbers, within +-most: up to twice that, where a unit is a last place. */
static real unit_ratio(real a, real unit, int most)
{
    if (ABS(a) / (real)most < unit) return DIV(a, unit);
    return a < 0 ? -(real)most * REAL(1.0) : (real)most * REAL(1.0);
}

static real seconds_of(uint32_t ms) { return DIV((real)(int32_t)ms, (real)1000); } /* ms <= 1300 */

/* A mean over MEAN_SECONDS; infinity would stay. */
static void average(real *mean, real value, real seconds)
{
    *mean += MUL(DIV(seconds, seconds + MEAN_SECONDS), within(value, REAL(1.0)) - *mean);
}

/* ---- The one-euro filter (Casiez, Roussel, Vogel 2012) ---------------------------------------- */

static edml_moving at_rest(point at)
{
    const edml_moving state = {at, {0, 0, 0}};
    return state;
}

/* The low-pass gain for a sample that comes turn / 2 pi seconds after the last.  turn <= 8.2 */
static real gain(real cutoff, real turn)
{
    if (!(cutoff < UNFILTERED)) return REAL(1.0);
    const real angle = MUL(turn, cutoff); /* Q16: < 2^31 - 2^16 */
    return DIV(angle, HERTZ(1) + angle);
}

/* Both filters, for a frame. */
typedef struct {
    edml_smoothing by;
    real unit;   /* of speed */
    real motion; /* the least gain: this part of what is new is motion */
    real noise;  /* how far noise puts joints off in a frame, units */
    /* By the time since a joint was last seen, see take_time(): */
    uint32_t ms;
    real turn;        /* 2 pi times it in seconds */
    real rate_gain;   /* of speed */
    real noise_speed; /* units per second */
} filter;

/* Motion goes on in the next frame, and noise does not: exact keypoints have a jitter of a third of their
 * steps, noise alone one of 1.4 times.  Neither depends on how large the steps are; what is small in the
 * image may be large in depth.
 *   step  the mean one, in the filter's own units */
static filter filter_by(edml_smoothing by, const edml_track *track, real step, real unit)
{
    filter made = {by, unit, 0, 0, 0, 0, 0, 0};
    if (!(track->noise_full > 0)) return made;
    const real share = unit_ratio(track->jitter, track->image_step, NOISY),
               full = FROM_API(track->noise_full);
    made.noise = MUL(share, step);    /* < 8 */
    if (!(share < full)) return made; /* also where nothing moves */
    const real part = DIV(share, full), square = SQUARE(part);
    made.motion = REAL(1.0) - SQUARE(square);
    return made;
}

/* The joints of a frame share one, but for those that were missing. */
static void take_time(filter *f, uint32_t ms)
{
    if (f->ms == ms) return;
    f->ms = ms;
    f->turn = MUL(REAL(6.2831853), seconds_of(ms));
    f->rate_gain = gain(RATE_CUTOFF, f->turn);
    const real rest = DIV(f->rate_gain, REAL(2.0) - f->rate_gain);
    f->noise_speed = PER_SECOND(MUL(SQRT(rest), f->noise), ms);
}

/* The speed of a joint without that of its noise. */
static real own_speed(const edml_moving *joint, const filter *f)
{
    const real speed = unit_ratio(norm(joint->rate), f->unit, FAR); /* norm: < sqrt(3) 2^30 */
    if (!(speed > f->noise_speed)) return 0;
    return ROOT_OF_EXACT(EXACT(speed, speed) - EXACT(f->noise_speed, f->noise_speed));
}

static point per_second(point a, uint32_t ms)
{
    const point rate = {PER_SECOND(a.x, ms), PER_SECOND(a.y, ms), PER_SECOND(a.z, ms)};
    return rate;
}

/* Moves a joint towards where it is seen, `ms` after the last time.  All of its coordinates have one cutoff,
 * by its speed, so that a rotation of the camera changes nothing. */
static void smooth(edml_moving *joint, point seen, uint32_t ms, filter *f)
{
    take_time(f, ms);
    const point step = minus(seen, joint->at); /* <= 2^30, or 2^28 in space */
    add_multiple(&joint->rate, f->rate_gain, minus(per_second(step, ms), joint->rate));
    real cutoff = f->by.cutoff;
    if (cutoff < UNFILTERED) cutoff += MUL(f->by.slope, own_speed(joint, f)); /* < 2^30 */
    const real alone = gain(cutoff, f->turn);
    add_multiple(&joint->at, alone > f->motion ? alone : f->motion, step);
}

/* ---- Right or reflected -------------------------------------------------------------------------- */

/* A choice between two: a pose or its mirror image; limbs as detected, or right and left swapped.
 *   belief      log-odds that the choices returned so far were right; updated
 *   evidence    log-odds of the choice that this frame alone speaks for
 *   continuity  log-odds that this choice continues the past; negative if the other one does
 * Returns whether the past choices must be flipped. */
static int flips(real *belief, real continuity, real evidence)
{
    const real link = within(continuity, MAX_LOG_ODDS);
    const real carried = within(*belief, ABS(link)); /* a chain is no stronger than its link */
    const real now = within(carried + (link < 0 ? -evidence : evidence), MAX_LOG_ODDS);
    *belief = ABS(now);
    return now < 0;
}

/* ---- The image: distances ------------------------------------------------------------------------ */

/* Was it seen lately? */
static int is_known(const edml_track *track, int j) { return track->joint[j].age <= HOLD_MS; }

/* The mean |x| + |y| of the seen joints from their mean: 2^30 at most, because a mean deviation is at most half
 * of the range. */
static pixels body_size(const edml_keypoint in[])
{
    const pixels count = (pixels)count_seen(seen_joints(in));
    pixels x = 0, y = 0, size = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(in[j].c > 0)) continue;
        x += in[j].x / count;
        y += in[j].y / count;
    }
    for (int j = 0; j < EDML_JOINTS; j++)
        if (in[j].c > 0) size += ABS(in[j].x - x) / count + ABS(in[j].y - y) / count;
    return size;
}

/* at + rate * seconds, 2^29 + 1.3 * 2^30 at most, within the range of pixels. */
static pixels expect_at(pixels at, pixels rate, real seconds)
{
    const pixels then = at + MUL(seconds, rate);
    if (IS_FINITE(then)) return then;
    return then > 0 ? MAX_PIXELS : -MAX_PIXELS;
}

/* Where the joints that were seen lately are expected `ms` after the last frame: until then, those that are
 * held moved along with the others. */
static void expect_joints(edml_keypoint expected[], const edml_track *track, uint32_t ms)
{
    const real seconds = seconds_of(ms);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_moving *image = &track->joint[j].image;
        expected[j].x = expect_at(image->at.x, image->rate.x, seconds);
        expected[j].y = expect_at(image->at.y, image->rate.y, seconds);
        expected[j].c = is_known(track, j) ? 1 : 0;
    }
}

/* Halved, so that two of them can be added: < 2^30. */
static pixels half_distance(edml_keypoint a, edml_keypoint b) { return HYPOT(a.x - b.x, a.y - b.y) / 2; }

/* Half of how far a joint is from where it is expected; or from where the joint of the other side is, if that
 * brings both of them nearer: the detector may have swapped them. */
static pixels joint_distance(const edml_keypoint in[], const edml_keypoint expected[], int j)
{
    const int k = edml_mirror_joint[j];
    const pixels straight = half_distance(in[j], expected[j]);
    if (!(in[k].c > 0 && expected[k].c > 0)) return straight;
    const pixels swapped = half_distance(in[j], expected[k]);
    const pixels more = half_distance(in[k], expected[j]), less = half_distance(in[k], expected[k]);
    return swapped + more < straight + less ? swapped : straight;
}

/* The median distance of the joints that are seen, and were seen lately: one or two may be far off.  In body
 * sizes, the smaller of the two, FAR at most.  Returns 0 if there are none. */
static int frame_distance(real *distance, const edml_track *track, const edml_keypoint in[], uint32_t ms)
{
    edml_keypoint expected[EDML_JOINTS];
    pixels sorted[EDML_JOINTS];
    int count = 0;
    expect_joints(expected, track, ms);
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(in[j].c > 0 && expected[j].c > 0)) continue;
        const pixels half = joint_distance(in, expected, j);
        int n = count++;
        for (; n > 0 && half < sorted[n - 1]; n--) sorted[n] = sorted[n - 1];
        sorted[n] = half;
    }
    if (count == 0) return 0;
    const pixels is = body_size(in), was = body_size(expected);
    *distance = within(unit_ratio(sorted[count / 2], (is < was ? is : was) / 2, FAR),
                       (real)FAR * REAL(1.0));
    return 1;
}

/* A distance within a body, in body sizes. */
static real limb(pixels a, pixels size)
{
    return within(unit_ratio(a, size, LIMB), (real)LIMB * REAL(1.0));
}

/* ---- Right and left ------------------------------------------------------------------------------ */

/* How much farther from where they are expected three right joints and their left ones would be if they were
 * swapped, in squares.  That is twice the product of right minus left, expected and now: 108 at most. */
static real side_continuity(const edml_keypoint expected[], const edml_keypoint in[], int right,
                            pixels size)
{
    real sum = 0;
    for (int r = right; r < right + 3; r++) {
        const int l = edml_mirror_joint[r];
        if (!(in[r].c > 0 && in[l].c > 0 && expected[r].c > 0 && expected[l].c > 0)) continue;
        const real x = limb(in[r].x - in[l].x, size), y = limb(in[r].y - in[l].y, size);
        sum += 2 * MUL(x, limb(expected[r].x - expected[l].x, size));
        sum += 2 * MUL(y, limb(expected[r].y - expected[l].y, size));
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
static int unswap_sides(edml_track *track, edml_keypoint in[], const edml_keypoint expected[], int right,
                        real *belief)
{
    const real evidence = MUL(SIDES_PER_SECOND, seconds_of(track->elapsed));
    const real far = side_continuity(expected, in, right, body_size(in));
    real continuity = PER_SECOND(MUL(SIDES_CONTINUE, far), track->elapsed);
    if (flips(belief, continuity, evidence)) {
        swap_past(track, right);
        continuity = -continuity;
    }
    if (!(continuity < 0)) return 0;
    swap_keypoints(in, right);
    return 1;
}

static void unswap(edml_track *track, edml_keypoint in[])
{
    edml_keypoint expected[EDML_JOINTS];
    expect_joints(expected, track, track->elapsed);
    if (unswap_sides(track, in, expected, EDML_R_SHOULDER, &track->arms_log_odds))
        track->swapped |= EDML_SWAPPED_ARMS;
    if (unswap_sides(track, in, expected, EDML_R_HIP, &track->legs_log_odds))
        track->swapped |= EDML_SWAPPED_LEGS;
}

/* ---- The image: filters --------------------------------------------------------------------------- */

/* Estimates how far keypoints are from the filtered ones, and their jitter: the change of the prediction
 * error from frame to frame.  Motion that is faster than predicted stays so for some frames; noise does not. */
static void estimate_jitter(edml_track *track, const edml_keypoint in[], pixels size)
{
    edml_keypoint expected[EDML_JOINTS];
    real jitter = 0, steps = 0; /* <= 14 * 8.5 / sqrt(2), 14 * 4.3 */
    int count = 0;
    expect_joints(expected, track, track->elapsed);
    for (int j = 0; j < EDML_JOINTS; j++) {
        edml_tracked_joint *joint = &track->joint[j];
        if (!(in[j].c > 0 && expected[j].c > 0)) continue;
        const real x = limb(in[j].x - expected[j].x, size), y = limb(in[j].y - expected[j].y, size);
        const real more = HYPOT(x - joint->innovation_x, y - joint->innovation_y);
        joint->innovation_x = x;
        joint->innovation_y = y;
        jitter += MUL(REAL(0.70710678), more); /* both errors have the noise */
        steps += HYPOT(limb(in[j].x - joint->image.at.x, size), limb(in[j].y - joint->image.at.y, size));
        count++;
    }
    if (count == 0) return;
    average(&track->jitter, jitter / (real)count, seconds_of(track->elapsed));
    average(&track->image_step, steps / (real)count, seconds_of(track->elapsed));
}

static int count_followed(const edml_track *track, const edml_keypoint in[])
{
    int count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) count += in[j].c > 0 && is_known(track, j);
    return count;
}

/* Smooths the seen joints; returns their mean motion: <= 2^30. */
static point smooth_seen(edml_track *track, edml_keypoint in[], pixels size)
{
    filter by = filter_by(track->smooth_image, track, track->image_step, size);
    const real count = (real)count_followed(track, in);
    point moved = {0, 0, 0};
    for (int j = 0; j < EDML_JOINTS; j++) {
        edml_tracked_joint *joint = &track->joint[j];
        const point seen = {in[j].x, in[j].y, 0}, before = joint->image.at;
        if (!(in[j].c > 0)) continue;
        if (is_known(track, j)) {
            smooth(&joint->image, seen, joint->age + track->elapsed, &by);
            moved.x += (joint->image.at.x - before.x) / count;
            moved.y += (joint->image.at.y - before.y) / count;
        } else {
            joint->image = at_rest(seen);
            joint->innovation_x = 0;
            joint->innovation_y = 0;
        }
        joint->age = 0;
        in[j].x = joint->image.at.x;
        in[j].y = joint->image.at.y;
    }
    return moved;
}

/* Holds joints that were seen lately where they were, moved along with the others, within the range. */
static uint16_t hold_missing(edml_track *track, edml_keypoint in[], point moved)
{
    uint16_t held = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        edml_tracked_joint *joint = &track->joint[j];
        if (in[j].c > 0) continue;
        const uint32_t age = joint->age + track->elapsed;
        joint->age = (uint16_t)(age <= HOLD_MS ? age : HOLD_MS + 1);
        if (!is_known(track, j)) continue;
        joint->image.at.x = expect_at(joint->image.at.x, moved.x, REAL(1.0));
        joint->image.at.y = expect_at(joint->image.at.y, moved.y, REAL(1.0));
        in[j].x = joint->image.at.x;
        in[j].y = joint->image.at.y;
        in[j].c = 1;
        held = (uint16_t)(held | 1U << j);
    }
    return held;
}

static void smooth_image(edml_track *track, edml_keypoint in[])
{
    track->swapped = 0;
    if (track->elapsed > 0) unswap(track, in);
    const pixels size = body_size(in); /* to the bit as without a swap */
    estimate_jitter(track, in, size);
    const point moved = smooth_seen(track, in, size);
    track->held = hold_missing(track, in, moved);
}

/* ---- Space ---------------------------------------------------------------------------------------- */

/* Takes the mirror image that persists.  In the camera's axes it has depths negated, but for the centimetre
 * or two of perspective that lift/fuse.h took out by the other depths.  The squared distances of the two from
 * the last pose differ by four times the product of the depths. */
static int choose_mirror(edml_track *track, edml_pose *out)
{
    wide products = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        products += PRODUCT(FROM_API(out->joint[j].z), track->joint[j].space.at.z);
    real continuity = PER_SECOND(MUL(4 * MIRROR_CONTINUES, SATURATE(products)), track->elapsed);
    if (flips(&track->mirror_log_odds, continuity, MIRROR_PER_FRAME)) {
        for (int j = 0; j < EDML_JOINTS; j++) {
            edml_moving *space = &track->joint[j].space;
            space->at.z = -space->at.z;
            space->rate.z = -space->rate.z;
        }
        continuity = -continuity;
    }
    if (!(continuity < 0)) return 0;
    for (int j = 0; j < EDML_JOINTS; j++) out->joint[j].z = -out->joint[j].z;
    return 1;
}

/* The mean distance of the joints from the filtered ones, metres: < 128. */
static real mean_step(const edml_track *track, const edml_pose *out)
{
    real mean = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        mean += norm(minus(pose_joint(out, j), track->joint[j].space.at)) / (int)EDML_JOINTS;
    return mean;
}

static void smooth_pose(edml_track *track, edml_pose *out)
{
    const int first = track->elapsed == 0;
    if (first) track->mirror_log_odds = MIRROR_AT_START;
    track->mirrored = (uint8_t)(first ? 0 : choose_mirror(track, out));
    if (!first) average(&track->space_step, mean_step(track, out), seconds_of(track->elapsed));
    filter by = filter_by(track->smooth_space, track, track->space_step, REAL(1.0));
    for (int j = 0; j < EDML_JOINTS; j++) {
        edml_moving *space = &track->joint[j].space;
        if (first)
            *space = at_rest(pose_joint(out, j));
        else
            smooth(space, pose_joint(out, j), track->elapsed, &by);
        out->joint[j] = api_point(space->at);
    }
}

/* ---- A frame -------------------------------------------------------------------------------------- */

void edml_track_start(edml_track *track)
{
    memset((void *)track, 0, sizeof *track);
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
    track->arms_log_odds = SIDES_AT_START;
    track->legs_log_odds = SIDES_AT_START;
    track->jitter = 0;
    track->image_step = 0;
    track->space_step = 0;
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
        const real most = ANOTHER_PERSON + MUL(ANOTHER_PER_SECOND, seconds_of(track->elapsed));
        real distance;
        if (frame_distance(&distance, track, in, track->elapsed) && distance <= most) return;
        track->leapt = 1;
        if (track->elapsed <= LEAP_MS) {
            track->aside = (uint16_t)track->elapsed;
            return;
        }
    }
    forget(track);
}

api_real edml_track_distance(const edml_track *track, const edml_keypoint in[EDML_JOINTS], uint32_t time_ms)
{
    if (track == NULL || in == NULL || !track->started) return API_MAX;
    const uint32_t later = time_ms - track->time, ms = later + track->aside;
    if (later == 0 || later > GAP_MS || ms > GAP_MS || !are_finite(in, seen_joints(in))) return API_MAX;
    real distance;
    return frame_distance(&distance, track, in, ms) ? TO_API(distance) : API_MAX;
}

static int is_usable(edml_smoothing by) { return by.cutoff > 0 && by.slope >= 0 && by.slope <= MAX_SLOPE; }

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
        !(track->noise_full >= 0 && track->noise_full <= MAX_NOISE_FULL))
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
        next.elapsed = 0;
        next.held = 0;
        next.swapped = 0;
        next.mirrored = 0;
    } else {
        out->seen = (uint16_t)(out->seen & ~next.held);
        smooth_pose(&next, out);
    }
    *track = next;
    return EDML_OK;
}

#endif
