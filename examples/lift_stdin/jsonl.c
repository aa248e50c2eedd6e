/* Lines of JSON: an object each.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "json.h"
#include "lift_stdin.h"

#define MOST_SECONDS 1e12 /* above, a double cannot tell milliseconds apart */

/* Is this the name of the member at p?  A name with escapes never is. */
static int is_named(const char *p, const char *name)
{
    const size_t length = strlen(name);
    return strncmp(p + 1, name, length) == 0 && p[1 + length] == '"';
}

/* A member of the object that the answer would repeat; or NULL. */
static const char *name_of_answer(const char *object, const options *set)
{
    static const char *const names[] = {"status", "joints",       "misfit", "quality", "placement",
                                        "root",   "reprojection", "focal",  "angles"};
    enum { ALWAYS = 3, QUALITY = 3, ANGLES = 8, NAMES = 9 };
    for (const char *p = json_first(object); p != NULL; p = json_next(json_value_of(p)))
        for (int n = 0; n < NAMES; n++)
            if (is_named(p, names[n]) && (n < ALWAYS || (n == QUALITY  ? set->quality
                                                         : n == ANGLES ? set->angles
                                                                       : places(set))))
                return names[n];
    return NULL;
}

static int is_object(const char *line)
{
    const char *end = json_value(line, JSON_DEPTH);
    return *line == '{' && end != NULL && *json_skip(end) == '\0';
}

/* The array of keypoints of the object, or null; NULL with what is wrong. */
static const char *find_keypoints(const char *object, const char **wrong)
{
    const char *found = NULL;
    for (const char *p = json_first(object); p != NULL; p = json_next(json_value_of(p))) {
        if (!is_named(p, "keypoints")) continue;
        if (found != NULL) return *wrong = "has keypoints twice", NULL;
        found = json_value_of(p);
    }
    if (found == NULL) return *wrong = "has no member \"keypoints\"", NULL;
    if (*found != '[' && *found != 'n') return *wrong = "keypoints is not an array", NULL;
    return found;
}

/* Reads null, [null, null], [x, y] or [x, y, c]; returns 0 for anything else. */
static int read_keypoint(edml_keypoint *keypoint, const char *p, float threshold)
{
    float numbers[3] = {0, 0, 0};
    int count = 0, nulls = 0;
    memset(keypoint, 0, sizeof *keypoint);
    if (*p == 'n') return 1;
    if (*p != '[') return 0;
    for (p = json_first(p); p != NULL; p = json_next(p), count++) {
        if (count == 3 || (*p != 'n' && *p != '-' && (*p < '0' || *p > '9'))) return 0;
        if (*p == 'n')
            nulls += count < 2 ? 1 : 4; /* x and y may be null, but only both */
        else
            numbers[count] = strtof(p, NULL);
    }
    if (count < 2 || (nulls != 0 && nulls != 2)) return 0;
    if (nulls == 0) *keypoint = keypoint_of(numbers, count, threshold);
    return 1;
}

/* Reads the member t of the object, seconds; returns NULL or what is wrong. */
static const char *read_time(double *time, const char *object)
{
    *time = -1;
    for (const char *p = json_first(object); p != NULL; p = json_next(json_value_of(p))) {
        if (!is_named(p, "t")) continue;
        if (*time >= 0) return "has t twice";
        const char *value = json_value_of(p);
        if (*value < '0' || *value > '9') return "t is not a number of seconds, 0 or more";
        *time = strtod(value, NULL);
        if (!(*time < MOST_SECONDS)) return "t is not a number of seconds below 1e12";
    }
    return *time < 0 ? "has no t" : NULL;
}

static const char *read_jsonl(edml_keypoint in[], double *time, const char *line, const options *set)
{
    static char wrong[128];
    const char *why = NULL;
    if (!is_object(line)) return "not a JSON object in one line (NaN and Infinity are not JSON)";
    const char *twice = name_of_answer(line, set);
    if (twice != NULL) {
        snprintf(wrong, sizeof wrong, "has a member \"%s\", which the answer adds: rename it", twice);
        return wrong;
    }
    const char *keypoints = find_keypoints(line, &why);
    if (keypoints == NULL) return why;
    if (set->track && set->fps == 0 && (why = read_time(time, line)) != NULL) return why;
    memset(in, 0, (size_t)keypoints_of(set) * sizeof *in);
    if (*keypoints == 'n' || json_first(keypoints) == NULL) return NULL; /* nobody */
    int count = 0;
    for (const char *p = json_first(keypoints); p != NULL; p = json_next(p), count++) {
        if (count >= keypoints_of(set)) continue;
        if (read_keypoint(&in[count], p, set->threshold)) continue;
        snprintf(wrong, sizeof wrong, "keypoint %d is not null, [x, y] or [x, y, c]", count);
        return wrong;
    }
    if (count == keypoints_of(set)) return NULL;
    snprintf(wrong, sizeof wrong, "%d keypoints, but %s has %d%s", count, name_of(set), keypoints_of(set),
             hint_of(set));
    return wrong;
}

static void write_placement(const answer *out, int lifted)
{
    if (lifted)
        printf(",\"placement\":\"%s\"", out->placed);
    else
        fputs(",\"placement\":null", stdout);
    if (lifted && strcmp(out->placed, "ok") == 0)
        printf(",\"root\":[%.6g,%.6g,%.6g],\"reprojection\":%.6g,\"focal\":%.6g", (double)out->root.x,
               (double)out->root.y, (double)out->root.z, (double)out->reprojection, (double)out->focal);
    else
        fputs(",\"root\":null,\"reprojection\":null,\"focal\":null", stdout);
}

/* Writes the object that was read, with the answer behind its members; the answer alone if the line was no
 * object. */
static void write_jsonl(const char *line, const answer *out, const options *set)
{
    const int lifted = strcmp(out->status, "ok") == 0;
    if (line != NULL && is_object(line) && name_of_answer(line, set) == NULL)
        printf(json_first(line) != NULL ? "%.*s," : "%.*s", (int)(json_value(line, JSON_DEPTH) - 1 - line),
               line);
    else
        putchar('{');
    printf("\"status\":\"%s\"", out->status);
    for (int j = 0; j < EDML_JOINTS && lifted; j++)
        printf("%s[%.6g,%.6g,%.6g]", j == 0 ? ",\"joints\":[" : ",", (double)out->pose.joint[j].x,
               (double)out->pose.joint[j].y, (double)out->pose.joint[j].z);
    if (lifted)
        printf("],\"misfit\":%.6g", (double)out->pose.misfit);
    else
        fputs(",\"joints\":null,\"misfit\":null", stdout);
    if (set->quality && lifted)
        printf(",\"quality\":%.6g", (double)out->quality);
    else if (set->quality)
        fputs(",\"quality\":null", stdout);
    if (places(set)) write_placement(out, lifted);
    if (set->angles) write_angle_member(out, set);
    puts("}");
}

const line_format jsonl = {65536, read_jsonl, write_jsonl};
