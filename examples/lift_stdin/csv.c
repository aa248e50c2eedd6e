/* Lines of numbers.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lift_stdin.h"

static const char *skip_blanks(const char *p)
{
    while (*p == ' ' || *p == '\t' || *p == '\r') p++;
    return p;
}

/* Reads numbers separated by commas or blanks; returns their count or, where field n is none, -n.
 * At most `room` are kept, but all are counted. */
static int read_numbers(float *numbers, int room, const char *p)
{
    int count = 0;
    p = skip_blanks(p);
    while (*p != '\0') {
        char *end;
        const float value = strtof(p, &end);
        if (end == p || strchr(" \t\r,", *end) == NULL) return -1 - count;
        if (count < room) numbers[count] = value;
        count++;
        p = skip_blanks(end);
        if (*p != ',') continue;
        p = skip_blanks(p + 1);
        if (*p == '\0') return -1 - count; /* nothing after the comma */
    }
    return count;
}

static const char *read_csv(edml_keypoint in[], double *time, const char *line, const options *set)
{
    (void)time;
    static char wrong[128];
    float numbers[3 * KEYPOINTS_MAX];
    const int keypoints = keypoints_of(set);
    const int count = read_numbers(numbers, 3 * keypoints, line);
    if (*line == '{') return "a JSON object: give --json";
    if (count < 0) {
        snprintf(wrong, sizeof wrong, "field %d is not a number (commas or blanks separate them)", -count);
        return wrong;
    }
    if (count != 2 * keypoints && count != 3 * keypoints) {
        snprintf(wrong, sizeof wrong, "%d numbers, but %s has %d or %d%s", count, name_of(set),
                 2 * keypoints, 3 * keypoints, hint_of(set));
        return wrong;
    }
    const int each = count / keypoints;
    for (int n = 0; n < keypoints; n++) in[n] = keypoint_of(numbers + n * each, each, set->threshold);
    return NULL;
}

static void write_fields(const float *values, int count)
{
    for (int n = 0; n < count; n++)
        if (values == NULL)
            putchar(',');
        else
            printf(",%.6g", (double)values[n]);
}

static void write_csv(const char *line, const answer *out, const options *set)
{
    (void)line;
    const int lifted = strcmp(out->status, "ok") == 0;
    fputs(out->status, stdout);
    write_fields(lifted ? &out->pose.joint[0].x : NULL, 3 * EDML_JOINTS);
    write_fields(lifted ? &out->pose.misfit : NULL, 1);
    if (set->quality) write_fields(lifted ? &out->quality : NULL, 1);
    if (places(set)) {
        const int placed = lifted && strcmp(out->placed, "ok") == 0;
        printf(",%s", lifted ? out->placed : "");
        write_fields(placed ? &out->root.x : NULL, 3);
        write_fields(placed ? &out->reprojection : NULL, 1);
        write_fields(placed ? &out->focal : NULL, 1);
    }
    if (set->angles) write_angle_fields(out, set);
    putchar('\n');
}

void print_csv_header(const options *set)
{
    fputs("status", stdout);
    for (int j = 0; j < EDML_JOINTS; j++) printf(",x%d,y%d,z%d", j, j, j);
    fputs(",misfit", stdout);
    if (set->quality) fputs(",quality", stdout);
    if (places(set)) fputs(",placement,root_x,root_y,root_z,reprojection,focal", stdout);
    if (set->angles) write_angle_names();
    putchar('\n');
    fflush(stdout);
}

const line_format csv = {4096, read_csv, write_csv};
