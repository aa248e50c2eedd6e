/* Video: steady motion from the frames of a video, one at a time and none delayed (docs/video.md).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDMLIFT_VIDEO_H
#define EDMLIFT_VIDEO_H

#include "../edmlift.h"
#include "fixed.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A one-euro filter (Casiez, Roussel, Vogel, "1 euro filter", CHI 2012), which trades lag for steadiness: a
 * joint is low-passed at `cutoff` + `slope` * its speed.  A cutoff of 2048 Hz or more: no filter. */
typedef struct {
    float cutoff; /* Hz, > 0; lower is steadier */
    float slope;  /* Hz per unit of speed, >= 0 and finite; higher lags less in motion */
} edml_smoothing;

typedef struct {
    edml_point at, rate; /* rate: per second */
} edml_moving;

typedef struct {
    edml_moving image, space;
    float innovation_x, innovation_y; /* last prediction error (measured minus predicted), body sizes */
    uint16_t age;                     /* ms since the joint was last seen */
} edml_tracked_joint;

enum { EDML_SWAPPED_ARMS = 1, EDML_SWAPPED_LEGS = 2 };

/* One person in a video.  The caller keeps one for each person. */
typedef struct {
    /* Settings.  edml_track_start() sets them to measured defaults; change them after it. */
    edml_smoothing smooth_image; /* of keypoints; speed in body sizes per second.  The body size is the mean
                                    |x| + |y| of the seen joints from their mean */
    edml_smoothing smooth_space; /* of poses; speed in m/s */
    float noise_full; /* the filters act in full where `jitter` is this many times `image_step`, and less
                         where it is smaller.  Exact keypoints: about 1/3; noise alone: 1.4.  0 to 64;
                         0: always in full */
    /* Report on the last frame that was lifted. */
    float jitter; /* estimated keypoint jitter, body sizes: mean change of the prediction error from frame
                         to frame, averaged over about 0.2 s */
    float image_step; /* how far keypoints are from the filtered ones of before, body sizes ... */
    float space_step; /* ... and lifted joints, metres; both averaged as `jitter` is */
    uint32_t elapsed; /* ms since the last frame of this person; 0: there is none, or too long ago */
    uint16_t held;    /* bit j: joint j was not seen in this frame, but lately */
    uint8_t swapped;  /* EDML_SWAPPED_ARMS, _LEGS: the detector swapped right and left */
    uint8_t mirrored; /* 1: not the mirror image that this frame alone would give */
    uint8_t leapt;    /* 1: another person, lifted by itself.  elapsed is 0 */
    /* State. */
    uint8_t started;
    uint16_t aside; /* ms from this person's last frame to another's, if that came last; or 0 */
    uint32_t time;  /* ms */
    float arms_log_odds, legs_log_odds, mirror_log_odds;
    edml_tracked_joint joint[EDML_JOINTS];
} edml_track;

void edml_track_start(edml_track *track);

/* edml_lift() of a video's frame, made steady by the frames before.
 *   pose     smoothed; `seen` and `misfit` are this frame's
 *   time_ms  of the frame, by any clock of milliseconds; it may wrap around
 * It undoes the detector's swaps of right and left arms (with shoulders) and legs (with hips); a swap that
 * lasts for over half a second is believed.  A mirror image that persists is believed as well.  Missing
 * joints stay where they were, moved along with the others, for 300 ms.  Frames may be dropped; after a
 * second without a lifted one, the next starts anew.
 * A frame shows somebody else if its edml_track_distance() is over 1 and twice the seconds since this
 * person's last frame.  It is lifted by itself, and the track waits for its person; over 100 ms after their
 * last frame, it starts anew with what is there.
 * At most 2.0 KB of stack.
 * A status other than EDML_OK leaves the track untouched, too.  Besides those of edml_lift():
 *   EDML_ERR_ARGUMENT        also: a track that was not started, or settings out of range
 *   EDML_ERR_TIME            not later than the last frame: a frame that was overtaken, a clock that was set
 *                            back, or over 24 days since; call edml_track_start()
 *   EDML_ERR_TOO_FEW_JOINTS  also: fewer than 7 seen, however many are held */
edml_status edml_track_lift(edml_pose *pose, edml_track *track, const edml_keypoint in[EDML_JOINTS],
                            uint32_t time_ms, const edml_point *up, const edml_model *model, void *work,
                            size_t work_bytes);

/* How far a frame's keypoints are from where the track expects them at that time, in body sizes (the smaller
 * of the track's and the frame's): the median over the joints that the frame shows and the track saw lately.
 * Right and left count as the detector may have swapped them.  One person's next frame is within 0.3 or so;
 * beyond 1 it is another person; 64 at most.  HUGE_VALF if the track cannot say: it was not started, has no
 * frame, or none within a second before this time; or keypoints are not finite.
 * To give each of several people their track, take the pair that is nearest, and then the next. */
float edml_track_distance(const edml_track *track, const edml_keypoint in[EDML_JOINTS], uint32_t time_ms);

/* Swaps right and left keypoints, in place, where edml_track_lift() found them swapped in the last frame:
 * edml_place() needs these with its pose.
 *   in  that frame's */
void edml_track_swap_sides(edml_keypoint in[EDML_JOINTS], const edml_track *track);

/* ---- In integers (fixed.h) ---- */

typedef struct {
    int32_t cutoff, slope; /* Q16; slope <= 32 */
} edml_smoothing_q;

typedef struct {
    edml_point_q24 at;   /* in the image pixels, Q16, z 0; in space metres, Q24 */
    edml_point_q24 rate; /* per second; within 2^30: 16384 pixels, 64 m */
} edml_moving_q;

typedef struct {
    edml_moving_q image, space;
    int32_t innovation_x, innovation_y; /* Q24 */
    uint16_t age;
} edml_tracked_joint_q;

typedef struct {
    edml_smoothing_q smooth_image, smooth_space;
    int32_t noise_full;                     /* Q16 */
    int32_t jitter, image_step, space_step; /* Q24 */
    uint32_t elapsed;
    uint16_t held;
    uint8_t swapped, mirrored, leapt, started;
    uint16_t aside;
    uint32_t time;
    int32_t arms_log_odds, legs_log_odds, mirror_log_odds; /* Q24 */
    edml_tracked_joint_q joint[EDML_JOINTS];
} edml_track_q;

void edml_track_start_q(edml_track_q *track);
edml_status edml_track_lift_q(edml_pose_q *pose, edml_track_q *track, const edml_keypoint_q in[EDML_JOINTS],
                              uint32_t time_ms, const edml_point_q *up, const edml_model *model, void *work,
                              size_t work_bytes);
int32_t edml_track_distance_q(const edml_track_q *track, const edml_keypoint_q in[EDML_JOINTS],
                              uint32_t time_ms); /* Q16; INT32_MAX if the track cannot say */
void edml_track_swap_sides_q(edml_keypoint_q in[EDML_JOINTS], const edml_track_q *track);

#ifdef __cplusplus
}
#endif

#endif
