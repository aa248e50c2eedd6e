/* Any bytes into lift_stdin's readers of JSON and of CSV: each line of the answer is whole and has a status that
 * exists.  Into its scanner of JSON as well: what that calls sound it can walk, to the same end.
 *
 * driver.h says how to run it; its pseudo-random inputs are changes of what detectors write.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L /* fmemopen(), open_memstream() */
#define main main_of_lift_stdin
#include "main.c"
#undef main

#include <ctype.h>
#include <stdlib.h>

#include "driver.h"
#include "json.h"

static void require(int holds, const char *what)
{
    if (holds) return;
    fprintf(stderr, "fuzz_stdin: %s\n", what);
    abort();
}

/* ---- The scanner --------------------------------------------------------------------------------- */

static const char *skip_blanks(const char *p) { return p + strspn(p, " "); }

/* Walks what is sound; returns where it ends. */
static const char *walk(const char *p, int depth)
{
    require(depth >= 0, "nested too deeply");
    const char *end = json_end(p);
    require(end > p, "a value without text");
    if (*p != '[' && *p != '{') return end;
    const char *last = p + 1, close = *p == '[' ? ']' : '}';
    const int members = *p == '{';
    for (p = json_first(p); p != NULL; p = json_after(p)) {
        if (members) {
            require(*p == '"', "a member without a name");
            p = json_member(p);
        }
        last = walk(p, depth - 1);
    }
    last = skip_blanks(last);
    require(*last == close && last + 1 == end, "a walk to another end");
    return end;
}

/* The values of a text, one behind another; returns how many are sound. */
static int scan(const uint8_t *data, size_t size)
{
    static json_input in;
    int sound = 0;
    FILE *file = fmemopen((void *)(uintptr_t)data, size, "r");
    require(file != NULL, "no memory");
    json_start(&in, file);
    while (json_next(&in) != EOF) {
        json_forget(&in, 0);
        if (!json_value(&in, JSON_DEPTH)) break;
        sound++;
        const char *text = json_text(&in);
        require(strlen(text) == in.length, "a zero byte in a sound value");
        if (!in.too_long) require(*walk(text, JSON_DEPTH) == '\0', "a value does not end with its text");
    }
    fclose(file);
    return sound;
}

/* ---- The answers --------------------------------------------------------------------------------- */

static int is_status(const char *text, size_t length)
{
    static const char *const others[] = {"bad_line", "nobody", "too_many_people", "status"};
    for (int status = 0; edml_status_name((edml_status)status)[0] != '?'; status--)
        if (strlen(edml_status_name((edml_status)status)) == length &&
            strncmp(text, edml_status_name((edml_status)status), length) == 0)
            return 1;
    for (int n = 0; n < 4; n++)
        if (strlen(others[n]) == length && strncmp(text, others[n], length) == 0) return 1;
    return 0;
}

/* A line that was read: an object with one status, whose joints agree with it. */
static void check_object(const char *object)
{
    int statuses = 0, lifted = 0, joints = 0;
    for (const char *p = json_first(object); p != NULL; p = json_after(json_member(p))) {
        const char *value = json_member(p);
        if (json_is_named(p, "joints")) joints = *value == '[';
        if (!json_is_named(p, "status")) continue;
        statuses++;
        require(is_status(value + 1, (size_t)(json_end(value) - value) - 2), "an unknown status");
        lifted = strncmp(value, "\"ok\"", 4) == 0;
    }
    require(statuses == 1, "an answer without a status, or with two");
    require(lifted == joints, "joints without ok, or ok without them");
}

/* Each line is one object. */
static void check_json(char *text, size_t size)
{
    static json_input in;
    FILE *file = fmemopen(text, size, "r");
    require(file != NULL, "no memory");
    json_start(&in, file);
    while (json_peek(&in) != EOF) {
        const unsigned long line = in.line;
        require(json_peek(&in) == '{' && json_value(&in, JSON_DEPTH + 2), "an answer that is no object");
        require(json_peek(&in) == '\n' && in.line == line, "an answer of another number of lines than one");
        json_take(&in);
        check_object(text);
        text = strchr(text, '\n') + 1;
    }
    fclose(file);
}

static void check_csv(const char *text)
{
    while (*text != '\0') {
        const size_t length = strcspn(text, "\n");
        int fields = 1;
        for (size_t n = 0; n < length; n++) fields += text[n] == ',';
        require(text[length] == '\n', "a line that does not end");
        require(is_status(text, strcspn(text, ",")), "an unknown status");
        require(fields == 44, "another number of fields");
        text += length + 1;
    }
}

/* ---- Options ------------------------------------------------------------------------------------- */

/* Text that looks like CSV is read as such; the last byte says the rest. */
static options some_options(const uint8_t *data, size_t size)
{
    const edml_format *const formats[] = {NULL,          &edml_body25, &edml_movenet17,
                                          &edml_halpe26, &edml_coco17, &edml_blazepose33};
    const int byte = data[size - 1];
    options set = {.model = &edml_direct_w8, .format = formats[byte % 6]}; /* a line end: coco17 */
    set.json = !isalnum(data[0]) && data[0] != '-' && data[0] != '#' && data[0] != ',';
    set.track = byte / 6 % 3 != 0;
    set.fps = byte / 6 % 3 == 1 || !set.json ? 30 : 0;
    set.fixed = !set.track && byte / 18 % 2;
    set.mirrored = byte / 36 % 2;
    set.threshold = set.format != NULL ? DETECTORS_THRESHOLD : 0;
    if (set.mirrored || (set.format != NULL && set.format->normalised)) set.width = 1080, set.height = 1920;
    return set;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char *answers = NULL;
    size_t length = 0;
    FILE *const out = stdout, *const err = stderr;
    if (size == 0) return 0;
    (void)scan(data, size);
    const options set = some_options(data, size);
    FILE *file = fmemopen((void *)(uintptr_t)data, size, "r");
    stdout = open_memstream(&answers, &length);
    stderr = fopen("/dev/null", "w");
    require(file != NULL && stdout != NULL && stderr != NULL, "no memory");
    const int done = set.json ? lift_json(file, &set) : lift_csv(file, &set);
    print_warnings(&set);
    fclose(file);
    fclose(stderr);
    fclose(stdout);
    stdout = out;
    stderr = err;
    require(done || !set.json, "JSON has no heading");
    if (set.json && length > 0) check_json(answers, length);
    if (!set.json) check_csv(answers);
    free(answers);
    return 0;
}

/* ---- Inputs ---------------------------------------------------------------------------------------- */

/* As detectors write, with holes and in short: most changes are of what matters. */
static const char *const seeds[] = {
    "{\"id\":7,\"keypoints\":[[1.5,-2e3,0.9],[0,1],null,[null,null]],"
    "\"t\":{\"a\":[true,false,[]],\"b\":\"\\u00e9\\n\xC3\xA9\xF0\x9F\x98\x80\"}}\n",
    "{\"version\":1.3,\"people\":[{\"person_id\":[-1],\"pose_keypoints_2d\":[1,2,0.5,3,4,1]},[[1,2],[3,4]]]"
    "}\n",
    "[{\"image_id\":\"0.jpg\",\"keypoints\":[9,8,7],\"score\":2.9,\"idx\":1},{\"image_id\":\"1.jpg\"}]\n",
    "{\"meta_info\":{},\"instance_info\":[{\"frame_id\":1,\"instances\":[{\"keypoints\":[[1,2]],"
    "\"keypoint_scores\":[1]}]}]}\n{\"instances\":null}\n[]\n",
    "[{\"name\":\"person\",\"keypoints\":{\"x\":[1,2],\"y\":[3,4],\"visible\":[1,0]}}]\n",
    "{\"a\":1,\"landmarks\":[[{\"x\":0.1,\"y\":0.2,\"visibility\":1}],[]],\"b\":{}}\n# comment\nnull\n",
    "[null,[{\"x\":1,\"y\":2,\"name\":\"nose\"},{\"x\":1,\"y\":2}],[[{\"keypoints\":[]}]]]\n",
    "[[[309,444,1],[313,427,1],[301,423,1],[305,422,1],[272,417,1],[315,512,1],[270,492,1],[331,624,1],"
    "[195,604,1],[345,728,1],[165,732,1],[358,739,1],[276,730,1],[353,917,1],[266,906,1],[317,999,1],"
    "[230,995,1]],[]]\n",
    "309,444,313,427,301,423,305,422,272,417,315,512,270,492,331,624,195,604,345,728,165,732,358,739,276,"
    "730,353,917,266,906,317,999,230,995\nnan,,null,-1,0,0\n",
    "x0,y0,x1,y1,x2,y2,x3,y3,x4,y4,x5,y5,x6,y6,x7,y7,x8,y8,x9,y9,x10,y10,x11,y11,x12,y12,x13,y13,x14,y14,"
    "x15,y15,x16,y16,t\n309,444,313,427,301,423,305,422,272,417,315,512,270,492,331,624,195,604,345,728,"
    "165,732,358,739,276,730,353,917,266,906,317,999,230,995,now\n",
};
enum { SEEDS = (int)(sizeof seeds / sizeof seeds[0]) };

const char *const fuzz_target_names[] = {"lift_stdin", NULL};

void fuzz_select(int target) { (void)target; }

static uint64_t drawn, of_number;

static uint32_t some(uint32_t below) { return (uint32_t)(random_bits(of_number, drawn++) >> 32) % below; }

size_t fuzz_fill(uint8_t input[INPUT_BYTES], uint64_t number)
{
    static const char letters[] = "{}[]\",:\\0-1.e+ntu a\xC3\xA9\xED\xF4\xFF\x01\n\n,,";
    of_number = number;
    drawn = 0;
    const char *seed = seeds[some(SEEDS)];
    size_t length = strlen(seed);
    require(length <= INPUT_BYTES, "a seed is too long");
    memcpy(input, seed, length);
    for (uint32_t edits = some(8); edits > 0; edits--)
        input[some((uint32_t)length)] = (uint8_t)letters[some(sizeof letters - 1)];
    if (some(4) == 0) length = 1 + some((uint32_t)length);
    if (some(2) == 0) input[length - 1] = (uint8_t)some(256);
    return length;
}
