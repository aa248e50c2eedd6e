/* The command line of lift_stdin.
 *
 * SPDX-License-Identifier: MIT
 */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lift_stdin.h"

static const edml_model *const models[] = {
    &edml_distances_f32, &edml_distances_w16, &edml_distances_w8, &edml_direct_f32,
    &edml_direct_w16,    &edml_direct_w8,     &edml_fconn_f32,    &edml_fconn_w16,
    &edml_fconn_w8,      &edml_fconv_f32,     &edml_fconv_w8,
};
enum { MAX_SLOPE_FIXED = 32 }; /* edml_smoothing_q */
enum { MODELS = (int)(sizeof models / sizeof models[0]), FIRST_QUANTISED = 1 };

/* In three, because C99 promises no longer strings. */
static const char usage[] =
    "Usage: lift_stdin [OPTION]... < poses.csv > lifted.csv\n"
    "Lifts 2D poses to 3D, a line of input to a line of output, in order.\n"
    "\n"
    "Input: x y or x y c of each keypoint, in pixels, y down, separated by commas or blanks; c is a\n"
    "confidence.  Without --format the keypoints are the 14 joints that the networks take: head,\n"
    "neck base, right shoulder, elbow, wrist, left shoulder, elbow, wrist, right hip, knee, ankle,\n"
    "left hip, knee, ankle.  Blank lines and lines that start with # are skipped.  The first line may\n"
    "name its columns, which then have commas: x0,y0,c0,... or left_wrist_x, left_wrist_y and perhaps\n"
    "left_wrist_c (or _score, _confidence, _visibility), in any order; others are passed over.\n"
    "Not seen are keypoints with a confidence up to --threshold, with a blank, nan or null, with x and\n"
    "y both exactly 0 or -1, and outside the image if --image is given.\n"
    "\n"
    "Output: status,x0,y0,z0,...,x13,y13,z13,misfit in metres: x right, y down, z away from the\n"
    "camera, origin between the hips; misfit says how far image and network disagree.  A pose that\n"
    "cannot be lifted has a status other than ok and empty fields: too_few_joints (under 10 seen),\n"
    "not_finite (infinity), degenerate (on a point or a line, or like no person), or time (with\n"
    "--track, not later than the one before).  A line that is not a pose has bad_line.  Warnings of\n"
    "likely mistakes follow on standard error at the end.\n"
    "\n";
static const char usage_of_options[] =
    "  --format NAME   keypoints of a detector, such as coco17; --list-formats has all\n"
    "  --image W,H     size of the image in pixels: keypoints outside are not seen.  --focal needs it,\n"
    "                  and so do blazepose33 and movenet17, whose keypoints are shares of it\n"
    "  --mirrored      the image is a mirror image, as of a selfie\n"
    "  --up X,Y,Z      the upward direction in the camera's axes, as an accelerometer shows it, of any\n"
    "                  length: 0,-1,0 for a level camera; fconn and fconv make no use of it\n"
    "  --camera FX,FY,CX,CY\n"
    "                  lift (but not with --track) as if this camera (pixels) looked at the person, and\n"
    "                  place each pose before it: fields placement (ok, or why not),\n"
    "                  root_x, root_y, root_z (mid-hip, metres from the camera), reprojection (RMS,\n"
    "                  pixels) and focal follow; the joints are relative to the root and rotated as\n"
    "                  placed or, where placement is not ok, as without a camera; with --track the\n"
    "                  person's path is filtered from frame to frame;\n"
    "                  with --json, members \"placement\", \"root\":[x,y,z], \"reprojection\", \"focal\"\n"
    "  --focal F       the same with this focal length and the middle of the image; --focal sweep\n"
    "                  looks for the one that fits best: distances are then a guess; with --track\n"
    "                  the first pose decides, and the whole video has that focal length\n"
    "  --height M      the person's standing height in metres: poses get this size\n"
    "  --quality       a field quality follows misfit: 0 to 1, the chance of a mean error under 100 mm\n"
    "  --angles        the angles of the pose in degrees come last (docs/angles.md), empty where a joint\n"
    "                  was not seen; with --json, a member \"angles\":{\"right_elbow_flexion\":N,...}\n"
    "  --json          JSON as detectors write it, one value behind another: an object a person, with\n"
    "                  \"keypoints\":[[x,y,c],...], where a keypoint may be [x,y], null or an object of\n"
    "                  x, y and score; or a frame with its \"people\":[...]; or files of OpenPose, COCO,\n"
    "                  AlphaPose, mmpose, Ultralytics, tfjs or MediaPipe.  A line answers a person:\n"
    "                  members of the frame, all of the person's, a bad one's as well, and \"status\",\n"
    "                  \"joints\":[[x,y,z],...] and \"misfit\".  Without people: the status nobody\n";

static const char more_options[] =
    "  --track FPS     the lines are a video of one person, FPS frames a second: steady its motion;\n"
    "                  --track t: at the times that the objects of --json have, \"t\", in seconds;\n"
    "                  a line that is not a pose is a frame without one; one video a run.  With frames\n"
    "                  of people each has a track, by its \"idx\", \"track_id\", \"person_id\" or \"id\", "
    "else\n"
    "                  the nearest: \"person\" is its number.  A 17th has the status too_many_people\n"
    "  --hold-bones N  of a video: the first N poses, 60 at most, measure a person's bones, whose\n"
    "                  lengths all poses then have (default: 60); 0: bones are as each pose has them\n"
    "  --smooth-image CUTOFF,SLOPE, --smooth-space CUTOFF,SLOPE\n"
    "                  --track's one-euro filters of keypoints and of poses: a cutoff in Hz, lower is\n"
    "                  steadier, and how it rises with speed, in Hz per body size a second and per m/s\n"
    "                  (default: 2,4 and 2,2.5); a cutoff of 100000 filters nothing\n"
    "  --noise-full R  --track's filters act in full where the keypoints' noise is R of how they move,\n"
    "                  and less where it is smaller (default: 1); 0: always in full, as in the paper\n"
    "  --model NAME    network (default: distances_f32; with --fixed distances_w16), such as\n"
    "                  direct_w16; --list-models has all\n"
    "  --fixed         lift in fixed point, as on a core without an FPU; coordinates must be within\n"
    "                  8192 pixels\n"
    "  --threshold C   keypoints with confidence <= C are not seen (default: 0.1 with --format, else 0)\n"
    "  --header        print the names of the columns first\n"
    "  --list-formats  print the names of the formats and how many keypoints they have, and exit\n"
    "  --list-models   print the names of the networks and exit\n"
    "  --help          print this and exit\n"
    "  --version       print the version and exit\n"
    "\n"
    "Exit status: 0, also if poses were refused; 1 after a bad line; 2 after a wrong option or heading,\n"
    "or if input or output failed.\n";

/* The value of an option, given as "--name value" or "--name=value"; NULL if this is another option. */
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

static void refuse(const char *message)
{
    fprintf(stderr, "lift_stdin: %s\n", message);
    exit(EXIT_TROUBLE);
}

static void print_models(FILE *file)
{
    for (int n = 0; n < MODELS; n++) fprintf(file, "%s\n", edml_model_name(models[n]));
}

static void print_formats(FILE *file)
{
    for (int n = 0; edml_formats[n] != NULL; n++)
        fprintf(file, "%s %d\n", edml_formats[n]->name, edml_formats[n]->keypoints);
}

static void set_model(options *set, const char *name)
{
    for (int n = 0; n < MODELS; n++) {
        if (strcmp(edml_model_name(models[n]), name) != 0) continue;
        set->model = models[n];
        return;
    }
    fprintf(stderr, "lift_stdin: no model '%s'; there are:\n", name);
    print_models(stderr);
    exit(EXIT_TROUBLE);
}

static void set_format(options *set, const char *name)
{
    set->format = edml_format_find(name);
    if (set->format != NULL) return;
    fprintf(stderr, "lift_stdin: no format '%s'; there are, with their number of keypoints:\n", name);
    print_formats(stderr);
    exit(EXIT_TROUBLE);
}

static void set_threshold(options *set, const char *text)
{
    char *end;
    set->threshold = strtof(text, &end);
    if (end != text && *end == '\0' && set->threshold >= 0 && set->threshold <= FLT_MAX) return;
    fprintf(stderr, "lift_stdin: --threshold must be a finite number >= 0, not '%s'\n", text);
    exit(EXIT_TROUBLE);
}

static void set_image(options *set, const char *text)
{
    char *end;
    const unsigned long width = strtoul(text, &end, 10);
    const unsigned long height = *end == ',' ? strtoul(end + 1, &end, 10) : 0;
    set->width = (float)width;
    set->height = (float)height;
    const int digits = strspn(text, "0123456789,") == strlen(text);
    if (digits && *end == '\0' && width - 1 < 1000000 && height - 1 < 1000000) return;
    fprintf(stderr, "lift_stdin: --image must be WIDTH,HEIGHT in pixels, not '%s'\n", text);
    exit(EXIT_TROUBLE);
}

/* Reads `count` numbers separated by commas; returns 0 if the text is anything else. */
static int read_list(float *numbers, int count, const char *text)
{
    for (int n = 0; n < count; n++) {
        char *end;
        numbers[n] = strtof(text, &end);
        if (end == text || *end != (n + 1 < count ? ',' : '\0')) return 0;
        if (!(numbers[n] > -1e6F && numbers[n] < 1e6F)) return 0;
        text = end + 1;
    }
    return 1;
}

static void set_camera(options *set, const char *text)
{
    float n[4];
    const int read = read_list(n, 4, text);
    if (!read || !(n[0] > 0 && n[1] > 0)) {
        fprintf(stderr, "lift_stdin: --camera must be FX,FY,CX,CY in pixels, FX and FY over 0, not '%s'\n",
                text);
        exit(EXIT_TROUBLE);
    }
    const edml_camera camera = {n[0], n[1], n[2], n[3]};
    set->camera = camera;
}

static void set_up(options *set, const char *text)
{
    float n[3] = {0, 0, 0};
    const int read = read_list(n, 3, text);
    const float length = read ? sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) : 0;
    if (!(length > 0)) {
        fprintf(stderr, "lift_stdin: --up must be X,Y,Z, not all of them 0, and not '%s'\n", text);
        exit(EXIT_TROUBLE);
    }
    const edml_point up = {n[0] / length, n[1] / length, n[2] / length};
    set->up = up;
}

static void set_focal(options *set, const char *text)
{
    set->sweep = strcmp(text, "sweep") == 0;
    if (set->sweep || (read_list(&set->focal, 1, text) && set->focal > 0)) return;
    fprintf(stderr, "lift_stdin: --focal must be a number of pixels over 0 or 'sweep', not '%s'\n", text);
    exit(EXIT_TROUBLE);
}

static void set_track(options *set, const char *text)
{
    set->track = 1;
    if (strcmp(text, "t") == 0) return;
    if (read_list(&set->fps, 1, text) && set->fps >= 1 && set->fps <= 1000) return;
    fprintf(stderr, "lift_stdin: --track must be 1 to 1000 frames a second, or 't', not '%s'\n", text);
    exit(EXIT_TROUBLE);
}

static void set_hold_bones(options *set, const char *text)
{
    float count;
    if (read_list(&count, 1, text) && count >= 0 && count <= EDML_MEASURED_POSES &&
        count == floorf(count)) {
        set->hold_bones = (int)count;
        return;
    }
    fprintf(stderr, "lift_stdin: --hold-bones must be 0 to %d poses, not '%s'\n", EDML_MEASURED_POSES,
            text);
    exit(EXIT_TROUBLE);
}

static edml_smoothing read_smoothing(const char *name, const char *text)
{
    float n[2];
    const int read = read_list(n, 2, text);
    if (!read || !(n[0] > 0 && n[1] >= 0)) {
        fprintf(stderr,
                "lift_stdin: %s must be CUTOFF,SLOPE, a cutoff over 0 and a slope of 0 or more, "
                "both under 1e6, not '%s'\n",
                name, text);
        exit(EXIT_TROUBLE);
    }
    const edml_smoothing by = {n[0], n[1]};
    return by;
}

static void set_smooth_image(options *set, const char *text)
{
    set->smooth_image = read_smoothing("--smooth-image", text);
}

static void set_smooth_space(options *set, const char *text)
{
    set->smooth_space = read_smoothing("--smooth-space", text);
}

static void set_noise_full(options *set, const char *text)
{
    if (read_list(&set->noise_full, 1, text) && set->noise_full >= 0 && set->noise_full <= 64) return;
    fprintf(stderr, "lift_stdin: --noise-full must be a number from 0 to 64, not '%s'\n", text);
    exit(EXIT_TROUBLE);
}

static void set_height(options *set, const char *text)
{
    edml_pose zero = {{{0, 0, 0}}, 0, 0}; /* edml_fit_body() fails later with it than with a bad height */
    const int read = read_list(&set->body.height, 1, text);
    if (read && set->body.height > 0 && edml_fit_body(&zero, &set->body) != EDML_ERR_BODY) return;
    fprintf(stderr, "lift_stdin: --height must be a person's, 0.5 to 2.5 metres, not '%s'\n", text);
    exit(EXIT_TROUBLE);
}

/* Takes an option that has a value; returns 0 if it is another one. */
static int set_value(options *set, char **argv, int *i)
{
    static const struct {
        const char *name;
        void (*set)(options *set, const char *value);
    } settings[] = {
        {"--model", set_model},
        {"--format", set_format},
        {"--threshold", set_threshold},
        {"--image", set_image},
        {"--camera", set_camera},
        {"--focal", set_focal},
        {"--track", set_track},
        {"--height", set_height},
        {"--up", set_up},
        {"--hold-bones", set_hold_bones},
        {"--smooth-image", set_smooth_image},
        {"--smooth-space", set_smooth_space},
        {"--noise-full", set_noise_full},
    };
    for (unsigned n = 0; n < sizeof settings / sizeof *settings; n++) {
        const char *value = option_value(settings[n].name, argv, i);
        if (value == NULL) continue;
        settings[n].set(set, value);
        return 1;
    }
    return 0;
}

/* Takes an option without a value; returns 0 if it is another one. */
static int set_flag(options *set, const char *text)
{
    const struct {
        const char *name;
        int *flag;
    } flags[] = {
        {"--header", &set->header}, {"--quality", &set->quality},   {"--json", &set->json},
        {"--fixed", &set->fixed},   {"--mirrored", &set->mirrored}, {"--angles", &set->angles},
    };
    for (unsigned n = 0; n < sizeof flags / sizeof *flags; n++) {
        if (strcmp(text, flags[n].name) != 0) continue;
        *flags[n].flag = 1;
        return 1;
    }
    return 0;
}

/* Ends the program after an option that only prints. */
static void print_and_exit(const char *option)
{
    if (strcmp(option, "--list-models") == 0)
        print_models(stdout);
    else if (strcmp(option, "--list-formats") == 0)
        print_formats(stdout);
    else if (strcmp(option, "--help") == 0)
        printf("%s%s%s", usage, usage_of_options, more_options);
    else if (strcmp(option, "--version") == 0)
        puts("lift_stdin (edmlift) " EDML_VERSION_STRING);
    else
        return;
    if (fflush(stdout) != 0 || ferror(stdout)) refuse("cannot write output");
    exit(EXIT_OK);
}

/* Makes the camera of a focal length and an image size. */
static void finish_camera(options *set)
{
    if (set->focal == 0 && !set->sweep) return;
    if (set->camera.fx > 0) refuse("--camera has a focal length: give --camera or --focal, not both");
    if (set->width == 0) refuse("--focal needs the size of the image: --image WIDTH,HEIGHT");
    if (set->sweep) return;
    const edml_camera camera = {set->focal, set->focal, set->width / 2, set->height / 2};
    set->camera = camera;
}

options read_options(char **argv)
{
    options set = {.model = NULL, .threshold = -1, .noise_full = -1, .hold_bones = -1};
    for (int i = 1; argv[i] != NULL; i++) {
        if (set_value(&set, argv, &i)) continue;
        print_and_exit(argv[i]);
        if (set_flag(&set, argv[i])) continue;
        if (argv[i][0] != '-') {
            fprintf(stderr, "lift_stdin: takes no files: lift_stdin < '%s'\n", argv[i]);
            exit(EXIT_TROUBLE);
        } else {
            fprintf(stderr, "lift_stdin: unknown option '%s'; see --help\n", argv[i]);
            exit(EXIT_TROUBLE);
        }
    }
    if (set.model == NULL) set.model = models[set.fixed ? FIRST_QUANTISED : 0];
    if (set.fixed && edml_model_work_bytes_q(set.model) == 0)
        refuse("--fixed needs a quantised network, such as distances_w16");
    if (set.threshold < 0) set.threshold = set.format != NULL ? DETECTORS_THRESHOLD : 0;
    const int normalised = set.format != NULL && set.format->normalised;
    if (normalised && set.width == 0)
        refuse("keypoints of this format are normalised: give the image's size with --image WIDTH,HEIGHT");
    finish_camera(&set);
    if (set.mirrored && places(&set) && set.width == 0)
        refuse("--mirrored with --camera needs the size of the image: --image WIDTH,HEIGHT");
    if (set.hold_bones >= 0 && !set.track) refuse("--hold-bones is for a video: give --track, too");
    if (set.hold_bones < 0) set.hold_bones = EDML_MEASURED_POSES;
    if (!set.track && (set.smooth_image.cutoff > 0 || set.smooth_space.cutoff > 0 || set.noise_full >= 0))
        refuse("--smooth-image, --smooth-space and --noise-full are for --track");
    if (set.fixed && set.smooth_image.slope > MAX_SLOPE_FIXED)
        refuse("--smooth-image: with --fixed a slope is 32 at most");
    if (set.fixed && set.smooth_space.slope > MAX_SLOPE_FIXED)
        refuse("--smooth-space: with --fixed a slope is 32 at most");
    if (set.quality && set.track)
        refuse("--quality is for single lifts: give --quality or --track, not both");
    if (set.track && set.fps == 0 && !set.json)
        refuse("--track t takes the times of --json: give --json, or frames a second");
    if (set.json && set.header) refuse("--header is for CSV, not for --json");
    return set;
}
