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

/* Reads numbers separated by commas or blanks; returns their count or -1 where the text is neither.
 * At most `room` are kept, but all are counted. */
static int read_numbers(float *numbers, int room, const char *p)
{
    int count = 0;
    p = skip_blanks(p);
    while (*p != '\0') {
        char *end;
        const float value = strtof(p, &end);
        if (end == p || strchr(" \t\r,", *end) == NULL) return -1;
        if (count < room) numbers[count] = value;
        count++;
        p = skip_blanks(end);
        if (*p != ',') continue;
        p = skip_blanks(p + 1);
        if (*p == '\0') return -1; /* nothing after the comma */
    }
    return count;
}

static const char *read_csv(edml_keypoint in[], const char *line, const options *set)
{
    static char wrong[128];
    float numbers[3 * KEYPOINTS_MAX];
    const int keypoints = keypoints_of(set);
    const int count = read_numbers(numbers, 3 * keypoints, line);
    if (count < 0) return "not numbers separated by commas or blanks";
    if (count != 2 * keypoints && count != 3 * keypoints) {
        snprintf(wrong, sizeof wrong, "%d numbers, but %s has %d or %d", count, name_of(set),
                 2 * keypoints, 3 * keypoints);
        return wrong;
    }
    const int each = count / keypoints;
    for (int n = 0; n < keypoints; n++)
        in[n] = keypoint_of(numbers + n * each, each, set->threshold);
    return NULL;
}

static void write_csv(const char *line, const char *status, const edml_pose *pose)
{
    (void)line;
    fputs(status, stdout);
    if (pose == NULL) {
        for (int n = 0; n < 3 * EDML_JOINTS + 2; n++) putchar(',');
    } else {
        for (int j = 0; j < EDML_JOINTS; j++)
            printf(",%.6g,%.6g,%.6g", (double)pose->joint[j].x, (double)pose->joint[j].y,
                   (double)pose->joint[j].z);
        printf(",%.6g,%.6g", (double)pose->mirror_margin, (double)pose->residual);
    }
    putchar('\n');
}

void print_csv_header(void)
{
    fputs("status", stdout);
    for (int j = 0; j < EDML_JOINTS; j++) printf(",x%d,y%d,z%d", j, j, j);
    puts(",mirror_margin,residual");
    fflush(stdout);
}

const line_format csv = {4096, read_csv, write_csv};
