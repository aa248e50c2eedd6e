/* lift_stdin: 2D poses on standard input, 3D poses on standard output, line by line.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "lift_stdin.h"

enum { LINE_MAX_BYTES = 65536 };

#define MAX_NORMALISED 10.0F /* a keypoint outside the image may be this far off, in image sizes */

typedef enum { LINE_END, LINE_READ, LINE_TOO_LONG } line_result;

static int is_blank(int c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Reads a line without its end and its leading blanks, whatever bytes it holds.  A line that is too long
 * is read to its end; its beginning is kept. */
static line_result read_line(char line[LINE_MAX_BYTES + 1], size_t longest, size_t *length)
{
    size_t bytes = 0, kept = 0;
    int c;
    while ((c = getchar()) != EOF && c != '\n') {
        bytes++;
        if (kept < longest && !(kept == 0 && is_blank(c))) line[kept++] = (char)c;
    }
    line[kept] = '\0';
    *length = kept;
    if (c == EOF && bytes == 0) return LINE_END;
    return bytes > longest ? LINE_TOO_LONG : LINE_READ;
}

edml_keypoint keypoint_of(const float *numbers, int count, float threshold)
{
    edml_keypoint keypoint = {numbers[0], numbers[1], 1.0F};
    if (count == 3) keypoint.c = isfinite(numbers[2]) && numbers[2] <= threshold ? 0.0F : numbers[2];
    return keypoint;
}

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

/* The video so far. */
typedef struct {
    edml_track track;
    followed_person person;
    edml_camera camera; /* fx 0: not known yet */
    unsigned long frame;
    double time; /* of this line, seconds */
} video;

/* When this line's frame was, in milliseconds of a clock that wraps around. */
static uint32_t frame_time(const video *before, const options *set)
{
    const double ms = set->fps > 0 ? 1000.0 * (double)before->frame / (double)set->fps
                                   : 1000.0 * before->time + 0.5;
    return (uint32_t)fmod(floor(ms), 4294967296.0);
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

static edml_status lift_frame(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], video *before,
                              const options *set)
{
    if (!set->track) return lift_still(pose, in, set);
    const edml_status status = edml_track_lift(pose, &before->track, in, frame_time(before, set),
                                               knows_up(set) ? &set->up : NULL, set->model, &work,
                                               sizeof work);
    if (status == EDML_OK && before->track.elapsed == 0) start_person(&before->person);
    return status;
}

static int is_outside(edml_keypoint at, float width, float height)
{
    const int known = isfinite(at.x) && isfinite(at.y) && isfinite(at.c); /* else the lift refuses it */
    return known && (at.x < 0 || at.x > width || at.y < 0 || at.y > height);
}

/* Keypoints outside the image were not seen, however sure of them the detector is; normalised ones are
 * multiplied by its size.  Returns NULL or what is wrong with them. */
static const char *to_pixels(edml_keypoint in[], const options *set)
{
    const int normalised = set->format != NULL && set->format->normalised;
    const float width = normalised ? 1 : set->width, height = normalised ? 1 : set->height;
    for (int n = 0; n < keypoints_of(set) && set->width != 0; n++) {
        if (normalised && in[n].c > 0 &&
            (fabsf(in[n].x) > MAX_NORMALISED || fabsf(in[n].y) > MAX_NORMALISED))
            return "keypoints of this format are normalised, 0 to 1 within the image; these look like "
                   "pixels";
        if (is_outside(in[n], width, height)) in[n].c = 0;
        in[n].x *= normalised ? set->width : 1;
        in[n].y *= normalised ? set->height : 1;
    }
    return NULL;
}

static edml_status lift(answer *out, const edml_keypoint in[], video *before, const options *set)
{
    edml_keypoint joints[EDML_JOINTS];
    if (set->fixed) return lift_fixed(out, in, set);
    if (set->format != NULL) edml_adapt(joints, in, set->format);
    const edml_keypoint *seen = set->format != NULL ? joints : in;
    edml_status status = lift_frame(&out->pose, seen, before, set);
    if (status != EDML_OK) return status;
    if (set->track) { /* the keypoints that it was lifted from */
        if (seen != joints) memcpy(joints, seen, sizeof joints);
        edml_track_swap_sides(joints, &before->track);
        seen = joints;
    }
    if (set->quality && edml_quality(&out->quality, &out->pose) != EDML_OK)
        out->quality = 0; /* a joint beyond 4 m, which only a float network can give */
    if (set->body.height > 0) status = edml_fit_body(&out->pose, &set->body);
    if (status != EDML_OK) return status;
    if (set->track) hold_bones(&out->pose, &before->person, set);
    if (places(set) && set->track)
        place_frame(out, &before->person, &before->camera, seen, frame_time(before, set), set, &work,
                    sizeof work);
    else if (places(set))
        place(out, seen, set);
    return EDML_OK;
}

/* How many poses were refused, and the first one's line and status. */
typedef struct {
    unsigned long count, line;
    const char *status;
} refusals;

static void note_refusal(refusals *refused, unsigned long line, const char *status)
{
    if (refused->count++ > 0) return;
    refused->line = line;
    refused->status = status;
}

/* Lifts one line; returns NULL or what is wrong with it. */
static const char *lift_line(const line_format *lines, const char *line, unsigned long number,
                             video *before, const options *set, refusals *refused)
{
    edml_keypoint in[KEYPOINTS_MAX];
    answer out;
    const char *wrong = lines->read(in, &before->time, line, set);
    if (wrong == NULL) wrong = to_pixels(in, set);
    if (wrong != NULL) return wrong;
    const edml_status status = lift(&out, in, before, set);
    out.status = edml_status_name(status);
    if (status != EDML_OK) note_refusal(refused, number, out.status);
    lines->write(line, &out, set);
    return NULL;
}

/* Lifts every line; returns how many were bad. */
static unsigned long lift_lines(const line_format *lines, const options *set)
{
    static char buffer[LINE_MAX_BYTES + 1];
    static char too_long[32];
    static const answer bad_line = {.status = "bad_line"};
    unsigned long number = 0, bad = 0;
    refusals refused = {0, 0, NULL};
    size_t length = 0;
    line_result result;
    video before = {.frame = 0};
    edml_track_start(&before.track);
    snprintf(too_long, sizeof too_long, "longer than %d bytes", lines->longest);
    while (!ferror(stdout) && (result = read_line(buffer, (size_t)lines->longest, &length)) != LINE_END) {
        const int mark = ++number == 1 && strncmp(buffer, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0; /* BOM */
        const char *line = buffer + mark + strspn(buffer + mark, " \t\r");
        if (*line == '#' || line == buffer + length) continue;
        const int whole = result == LINE_READ && strlen(buffer) == length;
        const char *wrong = whole ? lift_line(lines, line, number, &before, set, &refused)
                            : result == LINE_TOO_LONG ? too_long
                                                      : "holds a zero byte";
        before.frame++;
        if (wrong != NULL) {
            fprintf(stderr, "lift_stdin: line %lu: %s\n", number, wrong);
            lines->write(whole ? line : NULL, &bad_line, set);
            bad++;
        }
        fflush(stdout);
    }
    if (refused.count > 0)
        fprintf(stderr, "lift_stdin: refused poses: %lu, the first in line %lu: %s\n", refused.count,
                refused.line, refused.status);
    if (bad > 0) fprintf(stderr, "lift_stdin: bad lines: %lu\n", bad);
    return bad;
}

int main(int argc, char **argv)
{
    (void)argc;
    const options set = read_options(argv);
    if (edml_model_check(set.model) != EDML_OK) {
        fprintf(stderr, "lift_stdin: model %s is damaged\n", edml_model_name(set.model));
        return EXIT_TROUBLE;
    }
    if (set.header) print_csv_header(&set);
    const unsigned long bad = lift_lines(set.json ? &jsonl : &csv, &set);
    if (ferror(stdin)) return fputs("lift_stdin: cannot read input\n", stderr), EXIT_TROUBLE;
    if (ferror(stdout)) return fputs("lift_stdin: cannot write output\n", stderr), EXIT_TROUBLE;
    return bad > 0 ? EXIT_BAD_LINES : EXIT_OK;
}
