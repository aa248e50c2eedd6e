/* Lines of numbers, perhaps below a heading.
 *
 * SPDX-License-Identifier: MIT
 */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "keypoints.h"

enum { LINE_MAX_BYTES = 4096 };

static char wrong[128]; /* what is wrong with a line */

static const char *skip_blanks(const char *p)
{
    while (*p == ' ' || *p == '\t' || *p == '\r') p++;
    return p;
}

/* Reads a number, or NaN from nothing or null; returns where it ends, or NULL if there is anything else. */
static const char *read_number(float *number, const char *p)
{
    char *end;
    *number = NAN;
    if (*p == ',' || *p == '\0') return p;
    if (strncmp(p, "null", 4) == 0)
        end = (char *)(uintptr_t)p + 4;
    else
        *number = strtof(p, &end);
    return end != p && strchr(" \t\r,", *end) != NULL ? end : NULL;
}

/* Reads numbers separated by commas or blanks; returns their count or, where field n is none, -n.
 * At most `room` are kept, but all are counted. */
static int read_numbers(float *numbers, int room, const char *p)
{
    for (int count = 0;;) {
        float number;
        p = read_number(&number, p);
        if (p == NULL) return -1 - count;
        if (count < room) numbers[count] = number;
        count++;
        p = skip_blanks(p);
        if (*p == '\0') return count;
        if (*p == ',') p = skip_blanks(p + 1);
    }
}

/* ---- The heading ------------------------------------------------------------------------------- */

/* Which number of the keypoints a column has: 3 * keypoint + axis; -1: none of them. */
static struct {
    short number[LINE_MAX_BYTES + 1];
    int columns; /* 0: there is no heading; below 0: it is of no use */
    int each;    /* 2 or 3 numbers a keypoint */
} heading;

/* The length of the field at p, without blanks around it; *next: the field behind it, or NULL. */
static int field_length(const char *p, const char **next)
{
    size_t length = strcspn(p, ",");
    *next = p[length] == ',' ? skip_blanks(p + length + 1) : NULL;
    while (length > 0 && strchr(" \t\r", p[length - 1]) != NULL) length--;
    return (int)length;
}

/* Is the field the end of a name, behind its last underscore? */
static int axis_of(const char *suffix, size_t length)
{
    static const char *const names[] = {"x", "y", "c", "score", "confidence", "visibility"};
    for (int n = 0; n < 6; n++) {
        size_t k = 0;
        while (k < length && tolower((unsigned char)suffix[k]) == names[n][k]) k++;
        if (k == length && names[n][k] == '\0') return n < 2 ? n : 2;
    }
    return -1;
}

/* x12, or left_wrist_x. */
static int number_of(const char *name, int length, const options *set)
{
    int at = length;
    while (at > 0 && name[at - 1] != '_') at--;
    if (at > 0) {
        const int axis = axis_of(name + at, (size_t)(length - at));
        const int keypoint = keypoint_named(name, (size_t)at - 1, set);
        return axis < 0 || keypoint < 0 ? -1 : 3 * keypoint + axis;
    }
    const int axis = length > 1 ? axis_of(name, 1) : -1;
    const size_t digits = axis >= 0 ? strspn(name + 1, "0123456789") : 0;
    return digits > 0 && (int)digits == length - 1 && digits < 4 ? 3 * (int)strtol(name + 1, NULL, 10) + axis : -1;
}

static int refuse_heading(const char *why, const options *set)
{
    const char *name = name_of_keypoint(0, set);
    fprintf(stderr, "lift_stdin: the heading %s; columns are x0,y0,c0,x1,...", why);
    if (name != NULL) fprintf(stderr, " or %s_x,%s_y,%s_score,... of", name, name, name);
    for (int n = 0; name != NULL && n < keypoints_of(set); n++)
        fprintf(stderr, "%s %s", n > 0 ? "," : "", name_of_keypoint(n, set));
    fputs(set->format == NULL ? "; a detector's keypoints need --format\n" : "\n", stderr);
    return 0;
}

static int refuse_column(int number, const char *how_many, const options *set)
{
    char why[96];
    const char *name = name_of_keypoint(number / 3, set), axis = "xyc"[number % 3];
    if (name == NULL)
        snprintf(why, sizeof why, "has %s column %c%d", how_many, axis, number / 3);
    else
        snprintf(why, sizeof why, "has %s column %s_%c or %c%d", how_many, name, axis, axis, number / 3);
    return refuse_heading(why, set);
}

/* Returns 0 unless each keypoint has its x and y, and all or none a confidence. */
static int check_heading(const unsigned char found[3 * KEYPOINTS_MAX], int most, const options *set)
{
    int confidences = 0;
    char why[384];
    if (most > keypoints_of(set)) {
        snprintf(why, sizeof why, "has %d keypoints, but %s has %d%s", most, name_of(set),
                 keypoints_of(set), formats_with(most, 0));
        return refuse_heading(why, set);
    }
    for (int n = 0; n < 3 * keypoints_of(set); n++) {
        confidences += n % 3 == 2 && found[n];
        if (found[n] == 1 || (n % 3 == 2 && found[n] == 0)) continue;
        return refuse_column(n, found[n] == 0 ? "no" : "more than one", set);
    }
    if (confidences > 0 && confidences < keypoints_of(set))
        return refuse_heading("has a confidence for some keypoints only", set);
    heading.each = confidences > 0 ? 3 : 2;
    return 1;
}

/* Words, at least two a keypoint: takes them as names of columns.  Returns 0 if the line is anything else. */
static int read_heading(const char *line, const options *set)
{
    unsigned char found[3 * KEYPOINTS_MAX] = {0};
    float number;
    int columns = 0, most = 0;
    const char *first = line; /* that is not blank, as the name of an index may be */
    while (*first == ',') first = skip_blanks(first + 1);
    if (read_number(&number, first) != NULL || *first == '{' || *first == '[') return 0;
    for (const char *p = line, *next; p != NULL; p = next, columns++) {
        const int n = number_of(p, field_length(p, &next), set);
        heading.number[columns] = (short)n;
        if (n < 0) continue;
        if (n / 3 >= most) most = n / 3 + 1;
        if (n < 3 * KEYPOINTS_MAX && found[n] < 2) found[n]++;
    }
    heading.columns = -1;
    if (strncmp(line, "status,", 7) == 0)
        (void)refuse_heading("is that of poses, which are lifted already", set);
    else if (columns < 2 * keypoints_of(set))
        heading.columns = 0;
    else if (check_heading(found, most, set))
        heading.columns = columns;
    return heading.columns != 0;
}

/* A line below the heading. */
static const char *read_row(edml_keypoint in[], const char *line, const options *set)
{
    float numbers[3 * KEYPOINTS_MAX];
    int columns = 0;
    for (const char *p = line, *next; p != NULL; p = next, columns++) {
        const int length = field_length(p, &next),
                  n = columns < heading.columns ? heading.number[columns] : -1;
        if (n < 0) continue;
        const char *end = length > 0 ? read_number(&numbers[n], p) : p;
        if (length == 0) numbers[n] = NAN;
        if (end == p + length) continue;
        snprintf(wrong, sizeof wrong, "field %d is not a number", columns + 1);
        return wrong;
    }
    if (columns != heading.columns) {
        snprintf(wrong, sizeof wrong, "%d fields, but the heading has %d", columns, heading.columns);
        return wrong;
    }
    for (int n = 0; n < keypoints_of(set); n++)
        in[n] = keypoint_of(numbers + 3 * n, heading.each, set->threshold);
    return NULL;
}

static const char *read_keypoints(edml_keypoint in[], const char *line, const options *set)
{
    float numbers[3 * KEYPOINTS_MAX];
    if (heading.columns > 0) return read_row(in, line, set);
    const int count = read_numbers(numbers, 3 * keypoints_of(set), line);
    if (*line == '{' || *line == '[') return "JSON: give --json";
    if (count < 0) {
        snprintf(wrong, sizeof wrong, "field %d is not a number (commas or blanks separate them)", -count);
        return wrong;
    }
    return take_numbers(in, numbers, count, set);
}

/* ---- Answers ----------------------------------------------------------------------------------- */

static void write_fields(const float *values, int count)
{
    for (int n = 0; n < count; n++)
        if (values == NULL)
            putchar(',');
        else
            printf(",%.6g", (double)values[n]);
}

static void write_answer(const answer *out, const options *set)
{
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

static void print_header(const options *set)
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

/* ---- All lines --------------------------------------------------------------------------------- */

typedef enum { LINE_END, LINE_READ, LINE_TOO_LONG } line_result;

static int is_blank(int c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Reads a line without its end and its leading blanks, whatever bytes it holds.  A line that is too long
 * is read to its end; its beginning is kept. */
static line_result read_line(char line[LINE_MAX_BYTES + 1], size_t *length, FILE *file)
{
    size_t bytes = 0, kept = 0;
    int c;
    while ((c = getc(file)) != EOF && c != '\n') {
        bytes++;
        if (kept < LINE_MAX_BYTES && !(kept == 0 && is_blank(c))) line[kept++] = (char)c;
    }
    line[kept] = '\0';
    *length = kept;
    if (c == EOF && bytes == 0) return LINE_END;
    return bytes > LINE_MAX_BYTES ? LINE_TOO_LONG : LINE_READ;
}

/* Answers a line; NULL: it was not read whole, and `why` says why not. */
static void answer_line(person *who, const char *line, const char *why, const options *set)
{
    static const answer bad_line = {.status = "bad_line"};
    answer out;
    if (line != NULL) why = read_keypoints(who->in, line, set);
    if (why == NULL) why = lift_person(&out, who, set);
    if (why != NULL) note_bad(who->line, why);
    write_answer(why != NULL ? &bad_line : &out, set);
    fflush(stdout);
    who->frame++;
}

int lift_csv(FILE *file, const options *set)
{
    static char buffer[LINE_MAX_BYTES + 1];
    static person who;
    line_result result;
    size_t length = 0;
    int first = 1;
    if (set->header) print_header(set);
    heading.columns = 0;
    who.line = who.frame = 0;
    who.time = -1;
    while (!ferror(stdout) && (result = read_line(buffer, &length, file)) != LINE_END) {
        const int mark = ++who.line == 1 && strncmp(buffer, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0; /* BOM */
        const char *line = skip_blanks(buffer + mark);
        if (*line == '#' || line == buffer + length) continue;
        const int whole = result == LINE_READ && strlen(buffer) == length;
        const int named = first && whole && read_heading(line, set);
        first = 0;
        if (named && heading.columns < 0) return 0;
        if (named) continue;
        answer_line(&who, whole ? line : NULL,
                    result == LINE_TOO_LONG ? "longer than 4096 bytes" : "holds a zero byte", set);
    }
    return 1;
}
