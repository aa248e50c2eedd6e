/* Finds people, and frames of them, in a stream of JSON.
 *
 * An object is a frame once a member that holds people comes by, else a person once it ends.  An array is a person
 * if its first element is a keypoint, else it holds people or frames.  So a person, or the members of a frame before
 * its people, is all that is kept.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "json.h"
#include "keypoints.h"
#include "person.h"

typedef enum {
    MALFORMED, /* no JSON */
    DONE,      /* people, who have their answers */
    SET,       /* a set of keypoints; its text is kept, as that of the next two is */
    OBJECT,    /* that is no person */
    NO_VALUE,  /* null */
    NUMBER,
    OTHER
} found;

static json_input in;
static struct {
    char head[JSON_TEXT + 2 * JSON_DEPTH]; /* of the frame, and before it of those that it is in */
    size_t head_at, head_end;
    unsigned long frame; /* from 1 */
    uint64_t key;        /* of the frame */
    int begins;          /* the next person begins a frame */
    int lists;           /* that this is within */
} at;

static const char frames_name[] = "instance_info"; /* mmpose */
static const char too_long[] = "longer than 65536 bytes";

static found read_element(int depth, const options *set);

/* ---- Answers ------------------------------------------------------------------------------------ */

static void count_frame(uint64_t key)
{
    if (at.begins || key != at.key) at.frame++;
    at.begins = 0;
    at.key = key;
}

/* A person whose text is kept from `start` on; `start` beyond the text: nobody. */
static json_person person_from(size_t start, int bare, unsigned long line)
{
    const char *text = json_text(&in);
    const json_person one = {line, at.head + at.head_at, start < in.length ? text + start : NULL, bare,
                             at.lists > 0};
    return one;
}

static void bad(unsigned long line, const char *wrong, const options *set)
{
    count_frame(at.begins ? 0 : at.key);
    answer_bad(NULL, line, wrong, set);
}

static void answer_text(size_t start, int bare, unsigned long line, const options *set)
{
    const json_person one = person_from(start, bare, line);
    if (in.too_long) {
        bad(line, too_long, set);
        return;
    }
    count_frame(at.lists > 0 ? frame_of(&one) : 0);
    answer_person(&one, at.frame - 1, set);
}

static void answer_nobody(unsigned long line, const options *set)
{
    json_forget(&in, 0);
    at.begins = 1;
    answer_text(0, 0, line, set);
    at.begins = 1;
}

/* ---- Frames ------------------------------------------------------------------------------------- */

/* Keeps the members of an object that are no arrays or objects; `end`: before this one. */
static void keep_head(const char *object, const char *end)
{
    at.head_at = at.head_end;
    at.head[at.head_end++] = '{';
    for (const char *p = json_first(object); p != NULL && p < end; p = json_after(json_member(p))) {
        const char *value = json_member(p);
        const size_t length = (size_t)(json_end(value) - p);
        if (*value == '[' || *value == '{' || at.head_end + length + 1 > JSON_TEXT) continue;
        if (at.head_end > at.head_at + 1) at.head[at.head_end++] = ',';
        memcpy(at.head + at.head_end, p, length);
        at.head_end += length;
    }
    at.head[at.head_end++] = '\0';
}

static void drop_head(size_t before)
{
    at.head_end = at.head_at;
    at.head_at = before;
}

/* What an object has been so far. */
typedef struct {
    unsigned long line;
    size_t start, end; /* of what is kept */
    int is_person, is_frame, twice, cut;
} object_state;

/* The people of a frame, or frames: an array, or null. */
static int read_people(object_state *object, int of_frame, int depth, const options *set)
{
    const size_t before = at.head_at;
    int sound = 1;
    keep_head(json_text(&in) + object->start, in.text + (of_frame ? object->end : 0));
    json_forget(&in, 0);
    at.begins = 1;
    if (json_peek(&in) == 'n') {
        sound = json_value(&in, depth);
        if (sound) answer_nobody(object->line, set);
    } else {
        const unsigned long line = in.line;
        at.lists++;
        const found people = read_element(depth, set);
        sound = people != MALFORMED;
        if (people == SET) answer_text(0, 1, line, set);
        at.lists--;
    }
    drop_head(before);
    json_forget(&in, 0);
    object->is_frame = 1;
    object->start = object->end = 0;
    at.begins = 1;
    return sound;
}

static int read_member(object_state *object, int depth, const options *set)
{
    const size_t name = in.length;
    if (!json_name(&in)) return 0;
    const char *text = json_text(&in) + name;
    const int of_frame = in.too_long || !json_is_named(text, frames_name);
    const int holds = json_peek(&in) == '[' || (of_frame && json_peek(&in) == 'n');
    const int people = !in.too_long && holds && (!of_frame || name_among(text, people_names) >= 0);
    const int is_person = !in.too_long && name_among(text, person_names) >= 0;
    if (people || is_person) object->twice += object->is_frame || object->is_person;
    if (people && !object->twice) return read_people(object, of_frame, depth, set);
    object->is_person |= is_person;
    if (!json_value(&in, depth)) return 0;
    object->cut |= in.too_long;
    if (in.too_long || object->is_frame) json_forget(&in, object->end);
    object->end = in.length;
    return 1;
}

static int is_empty(const char *value)
{
    return *value == 'n' || (*value == '[' && json_first(value) == NULL);
}

/* The sets of keypoints of one member: the object is a frame. */
static void answer_sets(const object_state *object, const options *set)
{
    const char *text = json_text(&in) + object->start, *member;
    const size_t before = at.head_at;
    const char *list = list_of_sets(text, &member);
    keep_head(text, member);
    at.begins = 1;
    for (const char *p = json_first(list); p != NULL; p = json_after(p)) {
        const int bare = *p != '{' || is_set_of_columns(p);
        const json_person one = {object->line, at.head + at.head_at, is_empty(p) ? NULL : p, bare, 1};
        count_frame(at.begins ? 0 : at.key);
        answer_person(&one, at.frame - 1, set);
    }
    at.begins = 1;
    drop_head(before);
}

static void bad_object(const object_state *object, const char *wrong, const options *set)
{
    const json_person one = person_from(object->start, 0, object->line);
    count_frame(at.begins ? 0 : at.key);
    answer_bad(object->is_frame ? NULL : &one, object->line, wrong, set);
}

/* Answers an object at its end, unless its people have their answers. */
static found end_object(const object_state *object, const options *set)
{
    const char *member;
    if (object->cut && !object->is_frame)
        bad(object->line, too_long, set);
    else if (object->twice)
        bad_object(object, "has more than one member that holds keypoints or people", set);
    else if (object->is_person && list_of_sets(json_text(&in) + object->start, &member) == NULL)
        answer_text(object->start, 0, object->line, set);
    else if (object->is_person && has_scores(json_text(&in) + object->start))
        bad_object(object, "has keypoint_scores beside several people: each needs its own", set);
    else if (object->is_person)
        answer_sets(object, set);
    else if (!object->is_frame)
        return is_set_of_columns(json_text(&in) + object->start) ? SET : OBJECT;
    return DONE;
}

static found read_object(int depth, const options *set)
{
    object_state object = {in.line, in.length, 0, 0, 0, 0, 0};
    int more;
    json_take(&in);
    object.end = in.length;
    if (json_next(&in) == '}') {
        json_take(&in);
        return OBJECT;
    }
    do {
        const int none_kept = object.end > 0 && in.text[object.end - 1] == '{';
        if (none_kept) json_forget(&in, object.end); /* and no comma */
        if (!read_member(&object, depth, set)) return MALFORMED;
    } while ((more = json_more(&in, '}')) > 0);
    object.cut |= in.too_long;
    return more == 0 ? end_object(&object, set) : MALFORMED;
}

/* ---- Arrays ------------------------------------------------------------------------------------- */

/* The rest of an array of which one element was read, as text. */
static found read_rest(int depth)
{
    int more;
    while ((more = json_more(&in, ']')) > 0)
        if (!json_value(&in, depth)) return MALFORMED;
    return more == 0 ? SET : MALFORMED;
}

/* Answers an element of a list of people that has no answer yet. */
static void answer_element(found element, size_t start, unsigned long line, const options *set)
{
    if (element == SET || element == OBJECT)
        answer_text(start, element == SET, line, set);
    else if (element != DONE)
        bad(line, "not a person: neither an object nor an array", set);
    json_forget(&in, 0);
}

/* Is the array whose first element this is a set of keypoints? */
static int begins_set(found element, size_t start)
{
    if (element == NUMBER) return 1;
    return (element == SET || element == OBJECT) && !in.too_long && is_keypoint(json_text(&in) + start);
}

static found read_list(int depth, const options *set)
{
    const int began = at.begins;
    const unsigned long first_line = in.line;
    int more, nulls = 0, decided = 0;
    json_take(&in);
    if (json_next(&in) == ']') {
        json_take(&in);
        answer_nobody(first_line, set);
        return DONE;
    }
    at.begins = 1;
    do {
        const size_t start = in.length;
        const unsigned long line = in.line;
        const found element = read_element(depth, set);
        if (element == MALFORMED) return MALFORMED;
        if (!decided && element == NO_VALUE) {
            nulls++;
            continue;
        }
        if (!decided && begins_set(element, start)) {
            at.begins = began;
            return read_rest(depth);
        }
        for (; nulls > 0; nulls--) bad(line, "not a person: null", set);
        decided = 1;
        answer_element(element, start, line, set);
    } while ((more = json_more(&in, ']')) > 0);
    if (!decided) at.begins = began;
    return more < 0 ? MALFORMED : decided ? DONE : SET;
}

/* A value that may be, or hold, people. */
static found read_element(int depth, const options *set)
{
    const int c = json_peek(&in);
    if (depth == 0 && (c == '[' || c == '{')) return json_value(&in, 0) ? OTHER : MALFORMED;
    if (c == '{') return read_object(depth - 1, set);
    if (c == '[') {
        at.lists++;
        const found list = read_list(depth - 1, set);
        at.lists--;
        if (list == DONE) at.begins = 1;
        return list;
    }
    if (!json_value(&in, depth)) return MALFORMED;
    return c == 'n' ? NO_VALUE : c == '-' || (c >= '0' && c <= '9') ? NUMBER : OTHER;
}

/* ---- The stream ---------------------------------------------------------------------------------- */

/* Goes to where the next value may begin: the next line or, if the one that failed began lines before, the next that
 * begins with a bracket. */
static void resume(unsigned long began)
{
    if (in.fault == began) {
        json_skip_line(&in);
        return;
    }
    while (json_peek(&in) != EOF && !(in.column_0 && (json_peek(&in) == '{' || json_peek(&in) == '[')))
        json_skip_line(&in);
}

static void refuse(unsigned long began, const options *set)
{
    static char wrong[96];
    const char *but = "(NaN and Infinity are not JSON)";
    if (in.fault == began)
        snprintf(wrong, sizeof wrong, "not JSON %s", but);
    else
        snprintf(wrong, sizeof wrong, "not JSON, as line %lu shows %s", in.fault, but);
    bad(began, wrong, set);
    resume(began);
}

static void read_top(const options *set)
{
    const unsigned long line = in.line;
    const int c = json_peek(&in);
    at.head_at = 0;
    at.head_end = 2;
    memcpy(at.head, "{", 2);
    at.lists = 0;
    at.begins = 1;
    in.fault = line;
    const found value = c == '{' || c == '[' || c == 'n' ? read_element(JSON_DEPTH, set) : MALFORMED;
    if (value == MALFORMED) {
        at.lists = 0;
        at.head_at = 0;
        refuse(line, set);
    } else if (value == NO_VALUE) {
        answer_nobody(line, set);
    } else if (value != DONE) {
        answer_text(0, value == SET, line, set);
    }
}

int lift_json(FILE *file, const options *set)
{
    static const unsigned char mark[] = {0xEF, 0xBB, 0xBF}; /* BOM */
    json_start(&in, file);
    at.frame = 0;
    for (int n = 0; n < 3 && json_peek(&in) == mark[n]; n++) json_take(&in);
    while (!ferror(stdout)) {
        json_forget(&in, 0);
        const int c = json_next(&in);
        json_forget(&in, 0);
        if (c == EOF) return 1;
        if (c == '#')
            json_skip_line(&in);
        else
            read_top(set);
    }
    return 1;
}
