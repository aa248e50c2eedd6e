/* What the parts of lift_stdin share.  csv.c and people.c find people in lines and in JSON; person.c,
 * keypoints.c and names.c read them; main.c lifts them, in fixed point by fixed.c; tracks.c and video.c know
 * each person of a video; mistakes.c looks for likely ones; options.c knows the command line.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef LIFT_STDIN_H
#define LIFT_STDIN_H

#include <stddef.h>
#include <stdio.h>

#include "edmlift.h"
#include "edmlift/body.h"
#include "edmlift/camera.h"
#include "edmlift/video.h"

enum { EXIT_OK = 0, EXIT_BAD_LINES = 1, EXIT_TROUBLE = 2 };
enum { KEYPOINTS_MAX = 255 }; /* of a format */

/* A detector's keypoints with scores up to this one are mostly guesses (docs/detectors.md). */
#define DETECTORS_THRESHOLD 0.1F

typedef struct {
    const edml_model *model;
    const edml_format *format; /* NULL: the joints of edml_lift() themselves */
    float threshold;           /* a keypoint with a confidence up to this was not seen */
    float width, height;       /* of the image, pixels; 0: not given */
    edml_point up;             /* a unit vector in the camera's axes; 0: not given */
    float focal;               /* pixels; 0: not given */
    edml_camera camera;        /* fx 0: none */
    int sweep;                 /* look for the focal length */
    int track;                 /* the lines are a video ... */
    float fps;                 /* ... of so many frames a second; 0: the lines have their times */
    int hold_bones;            /* so many of its poses measure the bones of all; 0: none */
    edml_smoothing smooth_image, smooth_space; /* cutoff 0: not given */
    float noise_full;                          /* negative: not given */
    edml_body body;                            /* height 0: not given */
    int quality;                               /* print it */
    int angles;                                /* print them */
    int mirrored;                              /* the image is a mirror image */
    int header, json, fixed;
} options;

/* The answer to a line. */
typedef struct {
    const char *status; /* nothing follows any but "ok" */
    edml_pose pose;     /* rotated as it was placed, if it was */
    float quality;
    long person;               /* the number of the track of one of several; below 0: none */
    const char *placed;        /* nothing follows any but "ok" */
    edml_point root;           /* mid-hip before the camera, metres */
    float reprojection, focal; /* pixels */
} answer;

/* Ends the program if an option only prints or is wrong. */
options read_options(char **argv);

static inline int places(const options *set) { return set->camera.fx > 0 || set->sweep; }

static inline int knows_up(const options *set)
{
    return set->up.x != 0 || set->up.y != 0 || set->up.z != 0;
}

/* The number of keypoints on a line. */
static inline int keypoints_of(const options *set)
{
    return set->format != NULL ? set->format->keypoints : EDML_JOINTS;
}

static inline const char *name_of(const options *set)
{
    return set->format != NULL ? set->format->name : "a pose";
}

/* Someone in a frame, as the input has them. */
typedef struct {
    unsigned long line, frame; /* from 1; from 0 */
    double time;               /* seconds; below 0: not known */
    int listed;                /* perhaps one of several */
    uint64_t id;               /* by which the input tells people apart; 0: none */
    edml_keypoint in[KEYPOINTS_MAX];
} person;

/* Lifts someone; returns NULL or what is wrong with the keypoints. */
const char *lift_person(answer *out, person *who, const options *set);

/* Says what is wrong with a line, or with a value that begins there. */
void note_bad(unsigned long line, const char *wrong);

/* Read all of the file.  The answer to a line, or a person, is written before they read on.  Return 0 if they
 * cannot. */
int lift_csv(FILE *file, const options *set);
int lift_json(FILE *file, const options *set);

/* One person of a video, in fixed point. */
typedef struct {
    edml_track_q track;
    edml_measured_body_q bones;
    edml_path_q path;
} followed_q;

/* One person of a video. */
typedef struct {
    edml_track track;
    edml_measured_body bones;
    edml_path path;
    followed_q fixed;   /* with --fixed, instead of these */
    uint64_t id;        /* of the input; 0: none */
    long number;        /* from 0, in the order of their first frames; below 0: it has none */
    double last_ms;     /* of its last frame */
    int in_use, alone;
} person_track;

/* The track of someone; NULL: there are too many people. */
person_track *find_track(const person *who, const edml_keypoint joints[EDML_JOINTS], double ms,
                         const options *set);

/* After a frame of this track: one that is refused does not begin it. */
void feed_track(person_track *track, double ms, int lifted);

/* Counts what likely mistakes show in a pose that was lifted; prints warnings at the end. */
void note_pose(const person *who, const edml_keypoint joints[EDML_JOINTS], float quality,
               const options *set);
void print_warnings(const options *set);

/* The angles of the pose in the answer, as columns or a member (angles.c). */
void write_angle_names(void);
void write_angle_fields(const answer *out, const options *set);
void write_angle_member(const answer *out, const options *set);

/* Lifts, sizes and places in integers; a coordinate that they cannot hold is not finite.  With a track, a frame
 * of it, milliseconds by any clock; the joints' sides are then put right. */
edml_status lift_fixed(answer *out, edml_keypoint joints[EDML_JOINTS], const edml_keypoint in[], double ms,
                       person_track *by, const options *set);
void start_fixed_track(edml_track_q *track, const options *set);

/* edml_track_distance_q(), in body sizes. */
float distance_fixed(const edml_track_q *track, const edml_keypoint joints[EDML_JOINTS], double ms);

/* In milliseconds of a clock that wraps around. */
uint32_t clock_of(double ms);

/* Puts a placement, or the reason for none, into the answer. */
void take_placement(answer *out, edml_status status, const edml_placement *placement, float focal);

/* Begins the bones and the path of a track. */
void start_person(person_track *by);

/* Gives a pose the bones that its person's poses have had so far. */
void hold_bones(edml_pose *pose, person_track *by, const options *set);

/* Places the pose of the answer on the person's path, before the camera of the video. */
void place_frame(answer *out, person_track *by, const edml_keypoint joints[EDML_JOINTS], uint32_t time_ms,
                 const options *set, void *work, size_t work_bytes);

#endif
