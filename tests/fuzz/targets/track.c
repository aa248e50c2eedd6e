/* edml_track_lift() of videos: people who move, are lost and are mistaken for others, at any times; and
 * edml_track_distance() and edml_track_swap_sides() of their frames.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS track
#include "../native.h"

static edml_work work;

enum {
    CAUSES = ALLOW(EDML_ERR_NOT_FINITE) | ALLOW(EDML_ERR_TOO_FEW_JOINTS) | ALLOW(EDML_ERR_DEGENERATE) |
             ALLOW(EDML_ERR_TIME)
};

typedef struct {
    edml_pose pose;
    edml_track track;
} video;

static api_real draw_setting(choices *from, double most)
{
    const uint32_t kind = draw_below(from, 8);
    return to_api(kind == 0   ? 0
                  : kind == 1 ? most
                  : kind == 2 ? draw_extreme(from)
                              : draw_magnitude(from, 1e-4, 30));
}

/* Are they those that the header calls legal? */
static int are_legal(const edml_track *track)
{
    const edml_smoothing *const by[] = {&track->smooth_image, &track->smooth_space};
    for (int n = 0; n < 2; n++)
        if (!(by[n]->cutoff > 0 && by[n]->slope >= 0 && by[n]->slope <= MAX_SLOPE)) return 0;
    return from_api(track->noise_full) >= 0 && from_api(track->noise_full) <= 64;
}

static void start(video *v, choices *from)
{
    memset(&v->pose, 0xA5, sizeof v->pose);
    edml_track_start(&v->track);
    if (!draw_one_in(from, 4)) return;
    const double most_slope = IS_EXACT ? 3e38 : 32;
    v->track.smooth_image.cutoff = draw_setting(from, 32767);
    v->track.smooth_image.slope = draw_setting(from, most_slope);
    v->track.smooth_space.cutoff = draw_setting(from, 32767);
    v->track.smooth_space.slope = draw_setting(from, most_slope);
    v->track.noise_full = draw_setting(from, 64);
}

/* The next frame of a video. */
static void move(sighting in[EDML_JOINTS], choices *from)
{
    const uint32_t kind = draw_below(from, 16);
    const double step = draw_magnitude(from, 0.01, 30);
    const double x = step * draw_between(from, -1, 1), y = step * draw_between(from, -1, 1);
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x += x + (kind < 6 ? 0.2 * step * draw_between(from, -1, 1) : 0);
        in[j].y += y + (kind < 6 ? 0.2 * step * draw_between(from, -1, 1) : 0);
        in[j].c = kind == 13 && draw_one_in(from, 4) ? 0 : kind > 5 || draw_one_in(from, 2) ? 1 : in[j].c;
    }
    const int right = kind == 11 ? EDML_R_SHOULDER : EDML_R_HIP;
    for (int r = right; r < right + 3 && (kind == 11 || kind == 12); r++) {
        const sighting one = in[r];
        in[r] = in[r + 3];
        in[r + 3] = one;
    }
    if (kind == 14) draw_frame(in, from);
    if (kind == 15) in[draw_below(from, EDML_JOINTS)].x = draw_extreme(from);
}

static uint32_t draw_step(choices *from)
{
    static const uint32_t steps[] = {0,   1,   16,   67,   100,  101,        300,
                                     301, 999, 1000, 1001, 2000, UINT32_MAX, 1U << 31};
    return draw_one_in(from, 4) ? steps[draw_below(from, 14)] : 33;
}

static void check_track(const edml_track *track, uint32_t time_ms)
{
    REQUIRE(from_real(track->jitter) >= 0 && from_real(track->jitter) <= 1, "a bad jitter");
    REQUIRE(from_real(track->image_step) >= 0 && from_real(track->image_step) <= 1,
            "a bad step of the image");
    REQUIRE(from_real(track->space_step) >= 0 && from_real(track->space_step) <= 1, "a bad step in space");
    REQUIRE(track->started && track->time == time_ms, "a frame that was not noted");
    REQUIRE(track->swapped <= 3 && track->mirrored <= 1 && track->leapt <= 1, "a report out of range");
    REQUIRE(track->elapsed <= 1000, "a frame after a gap has a past");
}

/* Sides are as the track says, and twice is not at all; what was seen on them is not held. */
static void check_sides(const edml_keypoint in[EDML_JOINTS], const edml_track *track, const edml_pose *pose)
{
    edml_keypoint sides[EDML_JOINTS];
    memcpy(sides, in, sizeof sides);
    edml_track_swap_sides(sides, track);
    REQUIRE(pose->seen == seen_of(sides), "another seen mask");
    REQUIRE((track->held & pose->seen) == 0 && track->held <= ALL_SEEN, "a joint that was seen is held");
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int swapped = j >= EDML_R_HIP        ? track->swapped & EDML_SWAPPED_LEGS
                            : j >= EDML_R_SHOULDER ? track->swapped & EDML_SWAPPED_ARMS
                                                   : 0;
        REQUIRE(memcmp(&sides[j], &in[swapped ? edml_mirror_joint[j] : j], sizeof sides[j]) == 0,
                "sides are not swapped as the track says");
    }
    edml_track_swap_sides(sides, track);
    REQUIRE(memcmp(sides, in, sizeof sides) == 0, "sides that are swapped twice are not as they were");
}

static void check_distance(const edml_track *track, const edml_keypoint in[EDML_JOINTS], uint32_t time_ms)
{
    const api_real distance = edml_track_distance(track, in, time_ms);
    REQUIRE(distance == API_MAX || (from_api(distance) >= 0 && from_api(distance) <= 64), "a bad distance");
    REQUIRE(track->started || distance == API_MAX, "a distance of a track without a frame");
}

/* The same video an hour later, in which a clock may wrap around. */
static void check_other_clock(video *later, const video *v, const edml_keypoint in[EDML_JOINTS],
                              uint32_t time_ms, const edml_model *model, edml_status status)
{
    REQUIRE(edml_track_lift(&later->pose, &later->track, in, time_ms + 3600000, NULL, model, &work,
                            sizeof work) == status,
            "another status by another clock");
    REQUIRE(are_same_poses(&later->pose, &v->pose), "another pose by another clock");
}

/* Whatever came before, over a second later the track begins anew, with the pose of a lift. */
static void check_end(video *v, uint32_t time_ms, const edml_model *model)
{
    static const double x[] = {0, 0, -36, -50, -44, 36, 54, 48, -26, -30, -32, 26, 30, 34};
    static const double y[] = {-160, -112, -100, -46, -16, -100, -48, -24, 0, 84, 168, 0, 86, 170};
    sighting person[EDML_JOINTS];
    edml_keypoint in[EDML_JOINTS];
    edml_pose alone;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const sighting one = {500 + x[j], 500 + y[j], 1};
        person[j] = one;
    }
    to_keypoints(in, person, EDML_JOINTS);
    REQUIRE(edml_lift(&alone, in, NULL, model, &work, sizeof work) == EDML_OK, "somebody is refused");
    REQUIRE(edml_track_lift(&v->pose, &v->track, in, time_ms, NULL, model, &work, sizeof work) == EDML_OK,
            "somebody is refused after a gap");
    REQUIRE(memcmp(v->pose.joint, alone.joint, sizeof alone.joint) == 0 && v->track.elapsed == 0,
            "after a gap a track goes on");
}

void FUZZ_TARGET(track)(choices *from)
{
    sighting frame[EDML_JOINTS];
    edml_keypoint in[EDML_JOINTS];
    video v, later;
    snapshot before;
    const edml_model *model = draw_model(from);
    const int both_clocks = draw_one_in(from, 8);
    uint32_t time_ms = draw_one_in(from, 2) ? UINT32_MAX - 100 : draw_bits(from, 4);
    start(&v, from);
    later = v;
    const int legal = are_legal(&v.track);
#ifdef EDML_FUZZ_Q
    checked_track_start(&v.track);
#endif
    draw_frame(frame, from);
    for (uint32_t n = 2 + draw_below(from, 10); n > 0; n--) {
        to_keypoints(in, frame, EDML_JOINTS);
        check_distance(&v.track, in, time_ms);
#ifdef EDML_FUZZ_Q
        const int32_t distance = edml_track_distance(&v.track, in, time_ms);
#endif
        take_snapshot(&before, &v, sizeof v);
        const edml_status status = edml_track_lift(&v.pose, &v.track, in, time_ms, NULL, model, &work,
                                                   sizeof work);
#ifdef EDML_FUZZ_Q
        edml_pose watched = v.pose;
        int32_t watched_distance;
        WATCH(status, checked_track_lift(&watched, &watched_distance, in, time_ms, model, &taken), &v.pose,
              &watched, offsetof(edml_pose, seen));
        REQUIRE(!fuzz_watches || distance == watched_distance, "another distance of watched numbers");
#endif
        if (both_clocks) check_other_clock(&later, &v, in, time_ms, model, status);
        if (check_status(status, legal ? CAUSES : ALLOW(EDML_ERR_ARGUMENT), &before)) {
            REQUIRE(legal, "settings out of range were taken");
            check_pose_about(&v.pose, 0.002); /* each hip is filtered by its own speed */
            check_track(&v.track, time_ms);
            check_sides(in, &v.track, &v.pose);
        }
        move(frame, from);
        time_ms += draw_step(from);
    }
    if (legal && v.track.started) check_end(&v, v.track.time + 1001, model);
}
