/* What the parts of lift_stdin share: main.c reads lines and lifts, in fixed point by fixed.c; video.c has
 * what a video knows beside its tracks; csv.c and jsonl.c know what a line looks like, options.c the command
 * line.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef LIFT_STDIN_H
#define LIFT_STDIN_H

#include <stddef.h>

#include "edmlift.h"
#include "edmlift/body.h"
#include "edmlift/camera.h"
#include "edmlift/video.h"

enum { EXIT_OK = 0, EXIT_BAD_LINES = 1, EXIT_TROUBLE = 2 };
enum { KEYPOINTS_MAX = 255 }; /* of a format */

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
    edml_body body;            /* height 0: not given */
    int quality;               /* print it */
    int angles;                /* print them */
    int header, json, fixed;
} options;

/* The answer to a line. */
typedef struct {
    const char *status; /* nothing follows any but "ok" */
    edml_pose pose;     /* rotated as it was placed, if it was */
    float quality;
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

/* What to try when the number of keypoints is wrong. */
static inline const char *hint_of(const options *set)
{
    return set->format != NULL ? "" : "; a detector's keypoints need --format";
}

/* One kind of line.  `read` fills the keypoints, and the time in seconds where lines have one, and
 * returns NULL, or what is wrong with the line; `write` answers the line, which is NULL if it was not read
 * whole. */
typedef struct {
    int longest; /* bytes of a line */
    const char *(*read)(edml_keypoint in[], double *time, const char *line, const options *set);
    void (*write)(const char *line, const answer *out, const options *set);
} line_format;

extern const line_format csv, jsonl;
void print_csv_header(const options *set);

/* The angles of the pose in the answer, as columns or a member (angles.c). */
void write_angle_names(void);
void write_angle_fields(const answer *out, const options *set);
void write_angle_member(const answer *out, const options *set);

/* Lifts, sizes and places in integers; a coordinate that they cannot hold is not finite. */
edml_status lift_fixed(answer *out, const edml_keypoint in[], const options *set);

/* Puts a placement, or the reason for none, into the answer. */
void take_placement(answer *out, edml_status status, const edml_placement *placement, float focal);

/* One person of a video, beside their track. */
typedef struct {
    edml_measured_body bones;
    edml_path path;
} followed_person;

void start_person(followed_person *person);

/* Gives a pose the bones that its person's poses have had so far. */
void hold_bones(edml_pose *pose, followed_person *person, const options *set);

/* Places the pose of the answer on the person's path.
 *   camera  of the video; fx 0: not known yet, and then found */
void place_frame(answer *out, followed_person *person, edml_camera *camera,
                 const edml_keypoint joints[EDML_JOINTS], uint32_t time_ms, const options *set, void *work,
                 size_t work_bytes);

/* A detection: x, y and perhaps c. */
edml_keypoint keypoint_of(const float *numbers, int count, float threshold);

#endif
