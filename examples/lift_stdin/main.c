/* lift_stdin: 2D poses on standard input, 3D poses on standard output.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "lift_stdin.h"

#define MAX_NORMALISED 10.0F /* a keypoint outside the image may be this far off, in image sizes */

void take_placement(answer *out, edml_status status, const edml_placement *placement, float focal)
{
    out->placed = edml_status_name(status);
    if (status != EDML_OK) return;
    out->root = placement->translation;
    out->reprojection = placement->reprojection;
    out->focal = focal;
    for (int j = 0; j < EDML_JOINTS; j++) {
        out->pose.joint[j].x = placement->joint[j].x - out->root.x;
        out->pose.joint[j].y = placement->joint[j].y - out->root.y;
        out->pose.joint[j].z = placement->joint[j].z - out->root.z;
    }
}

static edml_fconv_work work; /* large enough for every model */

static void place(answer *out, const edml_keypoint joints[EDML_JOINTS], const options *set)
{
    edml_placement placement;
    edml_camera camera = set->camera;
    const edml_status status = set->sweep ? edml_place_sweep(&placement, &camera, &out->pose, joints,
                                                             set->width, set->height, &work, sizeof work)
                                          : edml_place(&placement, &out->pose, joints, &camera, &work,
                                                       sizeof work);
    take_placement(out, status, &placement, camera.fx);
}

/* As the camera that is known sees it, if that can have seen it. */
static edml_status lift_still(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const options *set)
{
    const edml_point *up = knows_up(set) ? &set->up : NULL;
    if (set->camera.fx > 0) {
        const edml_status status = edml_lift_with_camera(pose, in, up, &set->camera, set->model, &work,
                                                         sizeof work);
        if (status != EDML_ERR_CAMERA) return status;
    }
    return edml_lift(pose, in, up, set->model, &work, sizeof work);
}

/* When someone was seen, in milliseconds. */
static double time_of(const person *who, const options *set)
{
    return set->fps > 0 ? 1000.0 * (double)who->frame / (double)set->fps : 1000.0 * who->time + 0.5;
}

static edml_status lift_frame(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], double ms,
                              person_track *by, const options *set)
{
    if (!set->track) return lift_still(pose, in, set);
    const edml_status status = edml_track_lift(pose, &by->track, in, clock_of(ms),
                                               knows_up(set) ? &set->up : NULL, set->model, &work,
                                               sizeof work);
    if (status == EDML_OK && by->track.elapsed == 0 && by->track.aside == 0) start_person(by);
    return status;
}

static int is_outside(edml_keypoint at, float width, float height)
{
    const int known = isfinite(at.x) && isfinite(at.y) && isfinite(at.c); /* else the lift refuses it */
    return known && (at.x < 0 || at.x > width || at.y < 0 || at.y > height);
}

/* Turns shares into pixels, as the format has them; returns NULL or what is wrong. */
static const char *to_pixels(edml_keypoint in[], const options *set)
{
    const int by = set->format != NULL ? set->format->normalised : EDML_NOT_NORMALISED;
    const float side = set->width > set->height ? set->width : set->height;
    if (by == EDML_NOT_NORMALISED) return NULL;
    for (int n = 0; n < keypoints_of(set); n++) {
        if (in[n].c > 0 && (fabsf(in[n].x) > MAX_NORMALISED || fabsf(in[n].y) > MAX_NORMALISED))
            return "keypoints of this format are normalised, 0 to 1 within the image; these look like "
                   "pixels";
        in[n].x = by == EDML_BY_SQUARE ? in[n].x * side - (side - set->width) / 2 : in[n].x * set->width;
        in[n].y = by == EDML_BY_SQUARE ? in[n].y * side - (side - set->height) / 2 : in[n].y * set->height;
    }
    return NULL;
}

/* Keypoints outside the image were not seen, however sure of them the detector is. */
static void drop_outside(edml_keypoint in[], const options *set)
{
    for (int n = 0; n < keypoints_of(set) && set->width > 0; n++)
        if (is_outside(in[n], set->width, set->height)) in[n].c = 0;
}

/* Makes one image of its mirror image, but for the names of sides. */
static void mirror(edml_keypoint in[], const options *set)
{
    for (int n = 0; n < keypoints_of(set) && set->mirrored; n++) in[n].x = set->width - in[n].x;
}

/* The joints that keypoints show. */
static void adapt(edml_keypoint joints[EDML_JOINTS], const edml_keypoint in[], const options *set)
{
    edml_keypoint seen[EDML_JOINTS];
    if (set->format != NULL)
        edml_adapt(seen, in, set->format);
    else
        memcpy(seen, in, sizeof seen);
    for (int j = 0; j < EDML_JOINTS; j++) joints[j] = seen[set->mirrored ? edml_mirror_joint[j] : j];
}

static edml_status lift(answer *out, edml_keypoint joints[EDML_JOINTS], double ms, person_track *by,
                        const options *set)
{
    edml_status status = lift_frame(&out->pose, joints, ms, by, set);
    if (by != NULL) feed_track(by, ms, status == EDML_OK);
    out->person = by != NULL ? by->number : -1;
    if (status != EDML_OK) return status;
    if (by != NULL) edml_track_swap_sides(joints, &by->track); /* the keypoints that it was lifted from */
    if (edml_quality(&out->quality, &out->pose) != EDML_OK)
        out->quality = 0; /* a joint beyond 4 m, which only a float network can give */
    if (set->body.height > 0) status = edml_fit_body(&out->pose, &set->body);
    if (status != EDML_OK) return status;
    if (by != NULL && by->track.aside > 0) by = NULL; /* somebody else, for a moment */
    if (by != NULL) hold_bones(&out->pose, by, set);
    if (places(set) && by != NULL)
        place_frame(out, by, joints, clock_of(ms), set, &work, sizeof work);
    else if (places(set))
        place(out, joints, set);
    return EDML_OK;
}

/* ---- What was refused, and what was bad --------------------------------------------------------- */

static struct {
    unsigned long count, line; /* how many poses were refused; the first one's line and status */
    const char *status;
} refused;
static unsigned long bad;

static void note_refusal(unsigned long line, const char *status)
{
    if (refused.count++ > 0) return;
    refused.line = line;
    refused.status = status;
}

void note_bad(unsigned long line, const char *wrong)
{
    fprintf(stderr, "lift_stdin: line %lu: %s\n", line, wrong);
    bad++;
}

const char *lift_person(answer *out, person *who, const options *set)
{
    edml_keypoint joints[EDML_JOINTS];
    const char *wrong = to_pixels(who->in, set);
    if (wrong != NULL) return wrong;
    drop_outside(who->in, set);
    mirror(who->in, set);
    adapt(joints, who->in, set);
    out->person = -1;
    const double ms = set->track ? time_of(who, set) : 0;
    person_track *by = set->track ? find_track(who, joints, ms, set) : NULL;
    if (set->track && by == NULL) {
        out->status = "too_many_people";
    } else {
        const edml_status status = set->fixed ? lift_fixed(out, joints, who->in, ms, by, set)
                                              : lift(out, joints, ms, by, set);
        out->status = edml_status_name(status);
        if (status == EDML_OK) note_pose(who, joints, out->quality, set);
        if (status == EDML_OK) return NULL;
    }
    note_refusal(who->line, out->status);
    return NULL;
}

static int report(const options *set)
{
    if (refused.count > 0)
        fprintf(stderr, "lift_stdin: refused poses: %lu, the first in line %lu: %s\n", refused.count,
                refused.line, refused.status);
    print_warnings(set);
    if (bad > 0) fprintf(stderr, "lift_stdin: bad lines: %lu\n", bad);
    if (ferror(stdin)) return fputs("lift_stdin: cannot read input\n", stderr), EXIT_TROUBLE;
    if (ferror(stdout)) return fputs("lift_stdin: cannot write output\n", stderr), EXIT_TROUBLE;
    return bad > 0 ? EXIT_BAD_LINES : EXIT_OK;
}

int main(int argc, char **argv)
{
    (void)argc;
    const options set = read_options(argv);
    if (edml_model_check(set.model) != EDML_OK) {
        fprintf(stderr, "lift_stdin: model %s is damaged\n", edml_model_name(set.model));
        return EXIT_TROUBLE;
    }
    const int done = set.json ? lift_json(stdin, &set) : lift_csv(stdin, &set);
    return done ? report(&set) : EXIT_TROUBLE;
}
