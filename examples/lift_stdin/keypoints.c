/* Sets of keypoints in JSON, as detectors write them.
 *
 * SPDX-License-Identifier: MIT
 */
#include "keypoints.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "json.h"

static char wrong[256]; /* what is wrong with the set */

edml_keypoint keypoint_of(const float *numbers, int count, float threshold)
{
    const edml_keypoint unseen = {0, 0, 0};
    const edml_keypoint found = {numbers[0], numbers[1], count == 3 ? numbers[2] : 1};
    if (isnan(found.x) || isnan(found.y)) return unseen;
    if (found.x == found.y && (found.x == 0 || found.x == -1)) return unseen; /* so detectors mark it */
    return count == 3 && !(found.c > threshold) ? unseen : found;
}

void order_axes(float *numbers, const options *set)
{
    if (set->format == NULL || set->format->normalised != EDML_BY_SQUARE) return;
    const float y = numbers[0];
    numbers[0] = numbers[1];
    numbers[1] = y;
}

/* ---- Which kind of array ----------------------------------------------------------------------- */

/* The value of the last member of one of these names; NULL: none has. */
static const char *member_of(const char *object, const char *const names[])
{
    const char *found = NULL;
    for (const char *p = json_first(object); p != NULL; p = json_after(json_member(p)))
        for (int n = 0; names[n] != NULL; n++)
            if (json_is_named(p, names[n])) found = json_member(p);
    return found;
}

static const char *const x_names[] = {"x", NULL}, *const y_names[] = {"y", NULL};
static const char *const c_names[] = {"score", "confidence", "visibility", "visible", "c", NULL};
static const char *const name_names[] = {"name", NULL};

static float number_at(const char *p) { return *p == 'n' ? NAN : strtof(p, NULL); }

/* Reads numbers, or null; returns how many there are, or -1 if there is anything else. */
static int read_numbers(float *numbers, int room, const char *array)
{
    int count = 0;
    if (array == NULL || *array != '[') return -1;
    for (const char *p = json_first(array); p != NULL; p = json_after(p), count++) {
        if (!json_is_number(p)) return -1;
        if (count < room) numbers[count] = number_at(p);
    }
    return count;
}

int is_keypoint(const char *text)
{
    const char *x = *text == '{' ? member_of(text, x_names) : NULL;
    const int count = read_numbers(NULL, 0, text);
    return x != NULL ? json_is_number(x) : count == 2 || count == 3;
}

int is_set_of_columns(const char *object)
{
    const char *x = member_of(object, x_names);
    return x != NULL && *x == '[';
}

static const char *first_of(const char *array) /* that is not null */
{
    const char *p = json_first(array);
    while (p != NULL && *p == 'n') p = json_after(p);
    return p;
}

int is_set(const char *array)
{
    const char *p = first_of(array);
    if (p == NULL) return json_first(array) != NULL;
    return json_is_number(p) || is_keypoint(p);
}

/* ---- A keypoint --------------------------------------------------------------------------------- */

/* [null, null], [x, y] or [x, y, c]: returns how many numbers, or 0. */
static int read_array(float numbers[3], const char *p, const options *set)
{
    const int count = read_numbers(numbers, 3, p);
    if (count < 2 || count > 3 || isnan(numbers[0]) != isnan(numbers[1])) return 0;
    if (count == 3 && isnan(numbers[2])) return 0;
    order_axes(numbers, set);
    return count;
}

/* The same of an object with x, y and perhaps a confidence. */
static int read_object(float numbers[3], const char *p)
{
    const char *value[3] = {member_of(p, x_names), member_of(p, y_names), member_of(p, c_names)};
    for (int n = 0; n < 3; n++) {
        if (value[n] == NULL ? n < 2 : !json_is_number(value[n])) return 0;
        if (value[n] != NULL) numbers[n] = number_at(value[n]);
    }
    if (isnan(numbers[0]) != isnan(numbers[1])) return 0;
    if (value[2] != NULL && isnan(numbers[2])) return 0;
    return value[2] != NULL ? 3 : 2;
}

/* null, an array or an object; returns 0 for anything else. */
static int read_keypoint(edml_keypoint *keypoint, const char *p, const options *set)
{
    float numbers[3] = {NAN, NAN, NAN};
    const int count = *p == 'n' ? 2 : *p == '{' ? read_object(numbers, p) : read_array(numbers, p, set);
    if (count > 0) *keypoint = keypoint_of(numbers, count, set->threshold);
    return count;
}

/* ---- Sets --------------------------------------------------------------------------------------- */

static const char *wrong_count(int count, const options *set)
{
    snprintf(wrong, sizeof wrong, "%d keypoints, but %s has %d%s", count, name_of(set), keypoints_of(set),
             formats_with(count, 0));
    return wrong;
}

/* Where the keypoint belongs: `place`, or where its name says; -1: nowhere. */
static int place_of(const char *p, int place, int *named, const options *set)
{
    const char *name = *p == '{' ? member_of(p, name_names) : NULL;
    if (name == NULL || *name != '"' || name_of_keypoint(0, set) == NULL) return place;
    const int length = (int)(json_end(name) - name) - 2;
    const int found = keypoint_named(name + 1, (size_t)length, set);
    (*named)++;
    if (found < 0)
        snprintf(wrong, sizeof wrong, "%s has no keypoint \"%.*s\"", name_of(set), length, name + 1);
    return found;
}

/* An array of keypoints. */
static const char *read_list(edml_keypoint out[], const char *array, const options *set)
{
    unsigned char taken[KEYPOINTS_MAX] = {0};
    int count = 0, named = 0;
    for (const char *p = json_first(array); p != NULL; p = json_after(p), count++) {
        if (count >= keypoints_of(set)) continue;
        const int place = place_of(p, count, &named, set);
        if (place < 0) return wrong;
        if (taken[place]++) return "two keypoints have the same name, or only some have one";
        if (read_keypoint(&out[place], p, set)) continue;
        snprintf(wrong, sizeof wrong, "keypoint %d is not null, [x, y], [x, y, c] or an object of these",
                 count);
        return wrong;
    }
    if (count != keypoints_of(set)) return wrong_count(count, set);
    return named == 0 || named == count ? NULL : "only some keypoints have a name";
}

const char *take_numbers(edml_keypoint out[], float *numbers, int count, const options *set)
{
    static char other_count[384];
    const int keypoints = keypoints_of(set);
    if (count != 2 * keypoints && count != 3 * keypoints) {
        snprintf(other_count, sizeof other_count, "%d numbers, but %s has %d or %d%s", count, name_of(set),
                 2 * keypoints, 3 * keypoints, formats_with(count, 1));
        return other_count;
    }
    const int each = count / keypoints;
    for (int n = 0; n < keypoints; n++) {
        order_axes(numbers + n * each, set);
        out[n] = keypoint_of(numbers + n * each, each, set->threshold);
    }
    return NULL;
}

/* One array of all numbers. */
static const char *read_flat(edml_keypoint out[], const char *array, const options *set)
{
    float numbers[3 * KEYPOINTS_MAX];
    const int count = read_numbers(numbers, 3 * keypoints_of(set), array);
    if (count < 0) return "keypoints are not all numbers";
    return take_numbers(out, numbers, count, set);
}

/* An object of three arrays, of which the last may be missing. */
static const char *read_columns(edml_keypoint out[], const char *object, const options *set)
{
    float column[3][KEYPOINTS_MAX];
    const char *c = member_of(object, c_names);
    const int count = read_numbers(column[0], KEYPOINTS_MAX, member_of(object, x_names));
    const int ys = read_numbers(column[1], KEYPOINTS_MAX, member_of(object, y_names));
    const int cs = c != NULL ? read_numbers(column[2], KEYPOINTS_MAX, c) : count;
    if (count < 0 || ys != count || cs != count)
        return "keypoints are not arrays x and y of as many numbers";
    if (count != keypoints_of(set)) return wrong_count(count, set);
    for (int n = 0; n < count; n++) {
        const float numbers[3] = {column[0][n], column[1][n], c != NULL ? column[2][n] : 1};
        out[n] = keypoint_of(numbers, c != NULL ? 3 : 2, set->threshold);
    }
    return NULL;
}

static const char *apply_scores(edml_keypoint out[], const char *scores, const options *set)
{
    float numbers[KEYPOINTS_MAX];
    const int count = read_numbers(numbers, KEYPOINTS_MAX, scores);
    if (count != keypoints_of(set)) return "keypoint_scores are not as many numbers as keypoints";
    for (int n = 0; n < count; n++) {
        const float all[3] = {out[n].x, out[n].y, numbers[n]};
        if (out[n].c != 0) out[n] = keypoint_of(all, 3, set->threshold);
    }
    return NULL;
}

const char *read_set(edml_keypoint out[], const char *text, const char *scores, const options *set)
{
    options any = *set; /* what stands apart counts, not a third number */
    if (scores != NULL) any.threshold = -INFINITY;
    memset(out, 0, (size_t)keypoints_of(set) * sizeof *out);
    const char *first = *text == '[' ? first_of(text) : NULL;
    const char *why = *text == '{'                             ? read_columns(out, text, &any)
                      : first != NULL && json_is_number(first) ? read_flat(out, text, &any)
                                                               : read_list(out, text, &any);
    return why == NULL && scores != NULL ? apply_scores(out, scores, set) : why;
}
