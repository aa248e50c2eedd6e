/* lift_stdin: 2D poses on standard input, 3D poses on standard output, line by line.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "edmlift.h"

enum { LINE_MAX_BYTES = 4096, NUMBERS_XY = 2 * EDML_JOINTS, NUMBERS_XYC = 3 * EDML_JOINTS };
enum { EXIT_OK = 0, EXIT_BAD_LINES = 1, EXIT_TROUBLE = 2 };

static const edml_model *const models[] = {&edml_fconn_f32};
enum { MODELS = (int)(sizeof models / sizeof models[0]) };

static const char usage[] =
    "Usage: lift_stdin [OPTION]... < poses.csv > lifted.csv\n"
    "Lifts 2D poses to 3D, a line of input to a line of output, in order.\n"
    "\n"
    "Input: 28 numbers (x y of each joint, pixels, y down) or 42 (x y c, confidence; c <= 0 means\n"
    "not seen), separated by commas or blanks, in the order head top, neck, right shoulder, elbow,\n"
    "wrist, left shoulder, elbow, wrist, right hip, knee, ankle, left hip, knee, ankle.  Blank\n"
    "lines and lines that start with # are skipped.\n"
    "\n"
    "Output: status,x0,y0,z0,...,x13,y13,z13,mirror_margin,residual in metres: x right, y down,\n"
    "z away from the camera, origin between the hips.  A pose that cannot be lifted has a status\n"
    "other than ok and empty fields; a line that is not a pose has the status bad_line.\n"
    "\n"
    "  --model NAME    network to use (default: the first of --list-models)\n"
    "  --threshold C   joints with confidence <= C are not seen (default: 0)\n"
    "  --header        print the names of the columns first\n"
    "  --list-models   print the names of the networks and exit\n"
    "  --help          print this and exit\n"
    "  --version       print the version and exit\n"
    "\n"
    "Exit status: 0; 1 if there was a bad line; 2 if input or output failed, or for a wrong option.\n";

typedef struct {
    const edml_model *model;
    float threshold;
    int header;
} options;

typedef enum { LINE_END, LINE_READ, LINE_TOO_LONG } line_result;

static int is_blank(int c) { return c == ' ' || c == '\t' || c == '\r'; }

/* Reads a line without its end and its leading blanks, whatever bytes it holds.  Of one that is
 * too long the beginning is kept, the rest read and dropped. */
static line_result read_line(char line[LINE_MAX_BYTES + 1], size_t *length)
{
    size_t bytes = 0, kept = 0;
    int c;
    while ((c = getchar()) != EOF && c != '\n') {
        bytes++;
        if (kept < LINE_MAX_BYTES && !(kept == 0 && is_blank(c))) line[kept++] = (char)c;
    }
    line[kept] = '\0';
    *length = kept;
    if (c == EOF && bytes == 0) return LINE_END;
    return bytes > LINE_MAX_BYTES ? LINE_TOO_LONG : LINE_READ;
}

static const char *skip_blanks(const char *p)
{
    while (is_blank(*p)) p++;
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

/* Fills the keypoints; returns NULL or what is wrong with the line. */
static const char *read_pose(edml_keypoint pose[EDML_JOINTS], const char *line, float threshold)
{
    float numbers[NUMBERS_XYC];
    const int count = read_numbers(numbers, NUMBERS_XYC, line);
    if (count < 0) return "not numbers separated by commas or blanks";
    if (count != NUMBERS_XY && count != NUMBERS_XYC) return "neither 28 nor 42 numbers";
    const int each = count / EDML_JOINTS;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const float *from = numbers + j * each;
        pose[j].x = from[0];
        pose[j].y = from[1];
        pose[j].c = 1.0F;
        if (each == 3) pose[j].c = isfinite(from[2]) && from[2] <= threshold ? 0.0F : from[2];
    }
    return NULL;
}

static void print_pose(const char *status, const edml_pose *pose)
{
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
    fflush(stdout);
}

static void print_header(void)
{
    fputs("status", stdout);
    for (int j = 0; j < EDML_JOINTS; j++) printf(",x%d,y%d,z%d", j, j, j);
    puts(",mirror_margin,residual");
    fflush(stdout);
}

/* Lifts one line; returns NULL or what is wrong with it.  Counts refused poses. */
static const char *lift_line(const options *set, const char *line, unsigned long *refused)
{
    edml_keypoint in[EDML_JOINTS];
    edml_pose pose;
    edml_work work;
    const char *wrong = read_pose(in, line, set->threshold);
    if (wrong != NULL) return wrong;
    const edml_status status = edml_lift(&pose, in, set->model, &work);
    if (status != EDML_OK) ++*refused;
    print_pose(edml_status_name(status), status == EDML_OK ? &pose : NULL);
    return NULL;
}

static int lift_all(const options *set)
{
    static char buffer[LINE_MAX_BYTES + 1];
    unsigned long number = 0, refused = 0, bad = 0;
    size_t length = 0;
    line_result result;
    if (set->header) print_header();
    while (!ferror(stdout) && (result = read_line(buffer, &length)) != LINE_END) {
        const int mark = ++number == 1 && strncmp(buffer, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0; /* BOM */
        const char *line = skip_blanks(buffer + mark);
        if (*line == '#' || line == buffer + length) continue;
        const char *wrong = result == LINE_TOO_LONG    ? "longer than 4096 bytes"
                            : strlen(buffer) != length ? "holds a zero byte"
                                                       : lift_line(set, line, &refused);
        if (wrong == NULL) continue;
        fprintf(stderr, "lift_stdin: line %lu: %s\n", number, wrong);
        print_pose("bad_line", NULL);
        bad++;
    }
    if (refused > 0) fprintf(stderr, "lift_stdin: refused poses: %lu\n", refused);
    if (bad > 0) fprintf(stderr, "lift_stdin: bad lines: %lu\n", bad);
    if (ferror(stdin)) return fputs("lift_stdin: cannot read input\n", stderr), EXIT_TROUBLE;
    if (ferror(stdout)) return fputs("lift_stdin: cannot write output\n", stderr), EXIT_TROUBLE;
    return bad > 0 ? EXIT_BAD_LINES : EXIT_OK;
}

static const edml_model *find_model(const char *name)
{
    for (int n = 0; n < MODELS; n++)
        if (strcmp(edml_model_name(models[n]), name) == 0) return models[n];
    return NULL;
}

static void print_models(FILE *file)
{
    for (int n = 0; n < MODELS; n++) fprintf(file, "%s\n", edml_model_name(models[n]));
}

/* Value of an option, given as "--name value" or "--name=value"; NULL if `arg` is another one. */
static const char *option_value(const char *name, char **argv, int *i)
{
    const size_t length = strlen(name);
    if (strncmp(argv[*i], name, length) != 0) return NULL;
    if (argv[*i][length] == '=') return argv[*i] + length + 1;
    if (argv[*i][length] != '\0') return NULL;
    if (argv[*i + 1] == NULL) {
        fprintf(stderr, "lift_stdin: %s needs a value\n", name);
        exit(EXIT_TROUBLE);
    }
    return argv[++*i];
}

static void set_model(options *set, const char *name)
{
    set->model = find_model(name);
    if (set->model != NULL) return;
    fprintf(stderr, "lift_stdin: no model '%s'; there are:\n", name);
    print_models(stderr);
    exit(EXIT_TROUBLE);
}

static void set_threshold(options *set, const char *text)
{
    char *end;
    set->threshold = strtof(text, &end);
    if (end != text && *end == '\0' && set->threshold >= 0) return;
    fprintf(stderr, "lift_stdin: --threshold must be a number >= 0, not '%s'\n", text);
    exit(EXIT_TROUBLE);
}

/* Ends the program after an option that only prints. */
static void finish(void)
{
    const int failed = fflush(stdout) != 0 || ferror(stdout);
    if (failed) fputs("lift_stdin: cannot write output\n", stderr);
    exit(failed ? EXIT_TROUBLE : EXIT_OK);
}

static options read_options(char **argv)
{
    options set = {models[0], 0.0F, 0};
    for (int i = 1; argv[i] != NULL; i++) {
        const char *value;
        if ((value = option_value("--model", argv, &i)) != NULL) {
            set_model(&set, value);
        } else if ((value = option_value("--threshold", argv, &i)) != NULL) {
            set_threshold(&set, value);
        } else if (strcmp(argv[i], "--header") == 0) {
            set.header = 1;
        } else if (strcmp(argv[i], "--list-models") == 0) {
            print_models(stdout);
            finish();
        } else if (strcmp(argv[i], "--help") == 0) {
            fputs(usage, stdout);
            finish();
        } else if (strcmp(argv[i], "--version") == 0) {
            puts("lift_stdin (edmlift) " EDML_VERSION_STRING);
            finish();
        } else {
            fprintf(stderr, "lift_stdin: unknown option '%s'; see --help\n", argv[i]);
            exit(EXIT_TROUBLE);
        }
    }
    return set;
}

int main(int argc, char **argv)
{
    (void)argc;
    const options set = read_options(argv);
    if (edml_model_check(set.model) != EDML_OK) {
        fprintf(stderr, "lift_stdin: model %s is damaged\n", edml_model_name(set.model));
        return EXIT_TROUBLE;
    }
    return lift_all(&set);
}
