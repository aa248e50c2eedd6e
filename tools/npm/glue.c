/* What index.js calls.  It writes what is asked for into these variables, and reads the answers there.
 *
 * MODEL is the model's name: a program for each.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "edmlift.h" /* the library in one file, with its parts */

#define JOINED(a, b) a##b
#define NAMED(name) JOINED(edml_, name)
#define model NAMED(MODEL)

enum { PEOPLE = 64, KEYPOINTS = 33, THE_JOINTS = -1, FAR = 10 };

/* ---- What index.js writes and reads ------------------------------------------------------------- */

const char version[] = EDML_VERSION_STRING;
const int32_t most_people = PEOPLE; /* in a call */

/* LiftOptions of index.d.ts: how keypoints are read and people lifted. */
struct {
    int32_t format; /* in edml_formats, or THE_JOINTS */
    int32_t mirrored, knows_up, knows_camera;
    float threshold, width, height; /* of the picture, pixels; 0: not known */
    edml_point up;
    edml_camera camera;
} options;

edml_keypoint keypoints[PEOPLE * KEYPOINTS]; /* of all people, as the format has them */
edml_keypoint joints[PEOPLE][EDML_JOINTS];   /* that they were lifted from */
edml_pose poses[PEOPLE];
edml_status status[PEOPLE];
float quality, degrees[EDML_ANGLES];

/* One person's video: index.js keeps a copy for each. */
struct {
    edml_track track;
    edml_measured_body bones;
} person;

const int32_t person_bytes = sizeof person;

struct {
    uint32_t elapsed;
    int32_t held, swapped, mirrored, aside;
} report;

static edml_point above[PEOPLE]; /* options.up for each */
static edml_work work;

typedef char pose_of_44_words[sizeof(edml_pose) == 176 ? 1 : -1]; /* which index.js relies on */

/* ---- Keypoints to joints ------------------------------------------------------------------------ */

static const edml_format *format(void)
{
    return options.format == THE_JOINTS ? NULL : edml_formats[options.format];
}

static int is_nowhere(edml_keypoint k) { return k.x == k.y && (k.x == 0 || k.x == -1); }

/* NaN, and what detectors mark, is not seen; nor is what is not above the threshold. */
static edml_keypoint seen_only(edml_keypoint k)
{
    const edml_keypoint unseen = {0, 0, 0};
    if (isnan(k.x) || isnan(k.y)) return unseen;
    if (is_nowhere(k) || !(k.c > options.threshold)) k.c = 0;
    return k;
}

/* Detectors invent limbs outside the picture.  The lift refuses what is not finite, so that it stays. */
static edml_keypoint inside(edml_keypoint k, float width, float height)
{
    const int is_outside = k.x < 0 || k.y < 0 || k.x > width || k.y > height;
    if (is_outside && isfinite(k.x) && isfinite(k.y) && isfinite(k.c)) k.c = 0;
    return k;
}

static edml_keypoint in_pixels(edml_keypoint k, int normalised)
{
    const float width = options.width, height = options.height, side = width > height ? width : height;
    if (normalised == EDML_NOT_NORMALISED) return width > 0 ? inside(k, width, height) : k;
    if (normalised == EDML_BY_IMAGE) {
        k = inside(k, 1, 1);
        k.x *= width;
        k.y *= height;
        return k;
    }
    const float y = k.x;
    k.x = k.y * side - (side - width) / 2;
    k.y = y * side - (side - height) / 2;
    return inside(k, width, height);
}

static int is_far(edml_keypoint k) { return fabsf(k.x) > FAR || fabsf(k.y) > FAR; }

/* Returns 0 if keypoints of a normalised format are in pixels. */
static int prepare(edml_keypoint *k, int count, int normalised)
{
    for (const edml_keypoint *const end = k + count; k < end; k++) {
        *k = seen_only(*k);
        if (normalised != EDML_NOT_NORMALISED && k->c > 0 && is_far(*k)) return 0;
        *k = in_pixels(*k, normalised);
        if (options.mirrored) k->x = options.width - k->x;
    }
    return 1;
}

static void exchange_sides(edml_keypoint of[EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int mirror = edml_mirror_joint[j];
        if (mirror <= j) continue;
        const edml_keypoint other = of[mirror];
        of[mirror] = of[j];
        of[j] = other;
    }
}

/* The joints of so many people; returns 0 as prepare() does. */
static int read_joints(int people)
{
    const edml_format *const f = format();
    const int count = people * (f == NULL ? EDML_JOINTS : f->keypoints);
    if (!prepare(keypoints, count, f == NULL ? EDML_NOT_NORMALISED : f->normalised)) return 0;
    if (f == NULL)
        memcpy(joints, keypoints, (size_t)count * sizeof *keypoints);
    else
        edml_adapt_many(joints[0], keypoints, people, f);
    for (int n = 0; options.mirrored && n < people; n++) exchange_sides(joints[n]);
    return 1;
}

/* ---- Calls -------------------------------------------------------------------------------------- */

const char *model_name(void) { return edml_model_name(&model); }

edml_status check_model(void) { return edml_model_check(&model); }

const edml_format *format_at(int index) { return edml_formats[index]; } /* NULL behind the last */

/* Lifts so many people; returns how many were, or -1: keypoints of a normalised format are in pixels. */
int lift(int people)
{
    if (!read_joints(people)) return -1;
    for (int n = 0; n < people; n++) above[n] = options.up;
    return edml_lift_many(poses, status, joints[0], options.knows_up ? above : NULL,
                          options.knows_camera ? &options.camera : NULL, people, &model, &work,
                          sizeof work);
}

/* The quality of the first pose, which was lifted. */
void measure_quality(void) { (void)edml_quality(&quality, poses); }

/* The angles of the first pose. */
edml_status measure_angles(void)
{
    return edml_angles(degrees, poses, options.knows_up ? &options.up : NULL);
}

void start_person(void)
{
    edml_track_start(&person.track);
    edml_measure_start(&person.bones);
}

static void report_track(void)
{
    const edml_track *const track = &person.track;
    report.elapsed = track->elapsed;
    report.held = track->held;
    report.swapped = track->swapped;
    report.mirrored = track->mirrored;
    report.aside = track->aside > 0;
}

/* The first pose gets the bones of the person, which the first `most` poses measure. */
static void hold_bones(int most)
{
    if (person.track.elapsed == 0) edml_measure_start(&person.bones);
    if (person.bones.poses < most) (void)edml_measure_body(&person.bones, poses);
    if (person.bones.poses > 0) (void)edml_fit_body(poses, &person.bones.body);
}

/* Lifts the next frame of a person, and measures its quality; returns 0 as prepare() does. */
int track(uint32_t milliseconds, int bones)
{
    if (!read_joints(1)) return 0;
    status[0] = edml_track_lift(poses, &person.track, joints[0], milliseconds,
                                options.knows_up ? &options.up : NULL, &model, &work, sizeof work);
    if (status[0] != EDML_OK) return 1;
    report_track();
    edml_track_swap_sides(joints[0], &person.track);
    measure_quality();
    if (bones > 0 && !report.aside) hold_bones(bones);
    return 1;
}

/* From where the person's track expects them; -1 as prepare() does. */
float distance(uint32_t milliseconds)
{
    return read_joints(1) ? edml_track_distance(&person.track, joints[0], milliseconds) : -1;
}
