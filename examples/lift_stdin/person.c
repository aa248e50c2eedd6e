/* A person of JSON: its members, keypoints and answer.
 *
 * SPDX-License-Identifier: MIT
 */
#include "person.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "json.h"
#include "keypoints.h"

#define MOST_SECONDS 1e12 /* above, a double cannot tell milliseconds apart */

/* Own form, COCO and most others; OpenPose; MediaPipe in its languages. */
const char *const person_names[] = {"keypoints",     "pose_keypoints_2d", "landmarks", "landmark",
                                    "poseLandmarks", "pose_landmarks",    NULL};
/* OpenPose; mmpose; tfjs; others; COCO. */
const char *const people_names[] = {"people", "instances", "poses", "predictions", "annotations", NULL};
static const char *const scores_names[] = {"keypoint_scores", NULL};

int name_among(const char *p, const char *const names[])
{
    for (int n = 0; names[n] != NULL; n++)
        if (json_is_named(p, names[n])) return n;
    return -1;
}

/* ---- Members ------------------------------------------------------------------------------------ */

/* The value of the first of the names that a member of the object has; NULL: none. */
static const char *first_named(const char *object, const char *const names[])
{
    const char *found = NULL;
    int least = -1;
    for (const char *p = json_first(object); p != NULL; p = json_after(json_member(p))) {
        const int n = name_among(p, names);
        if (n < 0 || (least >= 0 && n >= least)) continue;
        least = n;
        found = json_member(p);
    }
    return found;
}

/* The name of the member at p if the answer has it as well; or NULL. */
static const char *name_of_answer(const char *p, int listed, const options *set)
{
    static const char *const names[] = {"status", "joints",    "misfit", "quality",
                                        "person", "placement", "root",   "reprojection",
                                        "focal",  "angles",    NULL};
    enum { ALWAYS = 3, QUALITY = 3, PERSON = 4, ANGLES = 9 };
    const int n = name_among(p, names);
    const int is_added = n < ALWAYS     ? n >= 0
                         : n == QUALITY ? set->quality
                         : n == PERSON  ? set->track && listed
                         : n == ANGLES  ? set->angles
                                        : places(set);
    return is_added ? names[n] : NULL;
}

/* The first member of an object that the answer would repeat; or NULL. */
static const char *repeated_name(const char *object, int listed, const options *set)
{
    const char *name = NULL;
    for (const char *p = json_first(object); p != NULL && name == NULL; p = json_after(json_member(p)))
        name = name_of_answer(p, listed, set);
    return name;
}

/* FNV-1a of a value's text. */
static uint64_t hash_of(const char *value)
{
    uint64_t hash = 14695981039346656037U;
    for (const char *end = json_end(value); value < end; value++)
        hash = (hash ^ (unsigned char)*value) * 1099511628211U;
    return hash;
}

uint64_t frame_of(const json_person *one)
{
    static const char *const names[] = {"image_id", "frame_id", "frame", "t", NULL};
    const char *value = one->text != NULL && !one->bare ? first_named(one->text, names) : NULL;
    return value != NULL ? hash_of(value) : 0;
}

/* By which the input tells people apart; 0: it does not.  COCO's annotations have an id each, whoever they are. */
static uint64_t id_of(const json_person *one)
{
    static const char *const names[] = {"idx", "track_id", "person_id", "id", NULL};
    static const char *const image[] = {"image_id", NULL};
    static const char *const alone[] = {"idx", "track_id", "person_id", NULL};
    if (one->bare) return 0;
    const int any = one->listed && first_named(one->text, image) == NULL;
    const char *value = first_named(one->text, any ? names : alone);
    if (value != NULL && *value == '[') value = json_first(value);
    if (value == NULL || *value == 'n') return 0;
    return json_end(value) - value == 2 && strncmp(value, "-1", 2) == 0 ? 0 : hash_of(value);
}

/* Reads t, in seconds, of a person or of its frame; returns NULL or what is wrong with it. */
static const char *read_time(double *time, const json_person *one)
{
    const char *value = NULL;
    for (int own = 1; own >= 0 && value == NULL; own--) {
        const char *object = own ? one->text : one->head;
        for (const char *p = own && one->bare ? NULL : json_first(object); p != NULL;
             p = json_after(json_member(p))) {
            if (!json_is_named(p, "t")) continue;
            if (value != NULL) return "has t twice";
            value = json_member(p);
        }
    }
    if (value == NULL) return "has no t";
    if (*value < '0' || *value > '9') return "t is not a number of seconds, 0 or more";
    *time = strtod(value, NULL);
    return *time < MOST_SECONDS ? NULL : "t is not a number of seconds below 1e12";
}

int has_scores(const char *object) { return first_named(object, scores_names) != NULL; }

const char *list_of_sets(const char *object, const char **member)
{
    for (const char *p = json_first(object); p != NULL; p = json_after(json_member(p))) {
        if (name_among(p, person_names) < 0) continue;
        const char *value = json_member(p);
        *member = p;
        return *value == '[' && json_first(value) != NULL && !is_set(value) ? value : NULL;
    }
    return NULL;
}

/* ---- Answers ------------------------------------------------------------------------------------ */

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

static int has_member(const char *object, const char *like)
{
    for (const char *p = json_first(object); p != NULL; p = json_after(json_member(p)))
        if (json_is_named_as(p, like)) return 1;
    return 0;
}

/* Writes the members of an object that are neither the answer's nor `but_for`'s. */
static void write_members_of(const char *object, const char *but_for, int listed, const options *set)
{
    for (const char *p = json_first(object); p != NULL; p = json_after(json_member(p))) {
        if (name_of_answer(p, listed, set) != NULL || (but_for != NULL && has_member(but_for, p))) continue;
        printf("%.*s,", (int)(json_end(json_member(p)) - p), p);
    }
}

/* Writes what was read: members of the frame that the person lacks, and the person's own. */
static void write_members(const json_person *one, const options *set)
{
    const char *text = one->text, *own = text != NULL && !one->bare ? json_first(text) : NULL;
    write_members_of(one->head, own != NULL ? text : NULL, one->listed, set);
    if (text != NULL && one->bare)
        printf("\"keypoints\":%.*s,", (int)(json_end(text) - text), text);
    else if (own != NULL && repeated_name(text, one->listed, set) != NULL)
        write_members_of(text, NULL, one->listed, set);
    else if (own != NULL) /* as it stands */
        printf("%.*s,", (int)(json_end(text) - 1 - own), own);
}

/* Writes a line: what was read, but for members that have names of the answer, and the answer. */
static void write_answer(const json_person *one, const answer *out, const options *set)
{
    const int lifted = strcmp(out->status, "ok") == 0;
    putchar('{');
    if (one != NULL) write_members(one, set);
    printf("\"status\":\"%s\"", out->status);
    if (set->track && one != NULL && one->listed && out->person >= 0)
        printf(",\"person\":%ld", out->person);
    else if (set->track && one != NULL && one->listed)
        fputs(",\"person\":null", stdout);
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
    fflush(stdout);
}

/* The member of a person that the answer adds as well; NULL: there is none. */
static const char *repeated(const json_person *one, const options *set)
{
    const char *name = repeated_name(one->head, one->listed, set);
    if (name != NULL || one->text == NULL || one->bare) return name;
    return repeated_name(one->text, one->listed, set);
}

void answer_bad(const json_person *one, unsigned long line, const char *wrong, const options *set)
{
    static const answer bad_line = {.status = "bad_line", .person = -1};
    note_bad(line, wrong);
    write_answer(one, &bad_line, set);
}

/* The keypoints and their scores; *set_text is NULL if nobody is there.  Returns NULL or what is wrong. */
static const char *find_set(const char **set_text, const char **scores, const json_person *one)
{
    *scores = NULL;
    *set_text = one->text;
    if (one->text == NULL) return NULL;
    if (!one->bare) {
        *set_text = first_named(one->text, person_names);
        *scores = first_named(one->text, scores_names);
    }
    if (*set_text == NULL) return "has no member \"keypoints\", nor another that people have";
    if (**set_text == 'n' || (**set_text == '[' && json_first(*set_text) == NULL)) *set_text = NULL;
    if (*set_text != NULL && **set_text != '[' && **set_text != '{') return "keypoints is not an array";
    return NULL;
}

/* Reads and lifts it; returns NULL or what is wrong. */
static const char *lift(answer *out, const json_person *one, unsigned long frame, const options *set)
{
    static person who;
    const char *keypoints, *scores, *why = find_set(&keypoints, &scores, one);
    if (why != NULL) return why;
    if (keypoints == NULL) {
        out->status = "nobody";
        out->person = -1;
        return NULL;
    }
    who.line = one->line;
    who.frame = frame;
    who.listed = one->listed;
    who.time = -1;
    who.id = set->track ? id_of(one) : 0;
    if (set->track && set->fps == 0) why = read_time(&who.time, one);
    if (why == NULL) why = read_set(who.in, keypoints, scores, set);
    return why != NULL ? why : lift_person(out, &who, set);
}

void answer_person(const json_person *one, unsigned long frame, const options *set)
{
    static char wrong[96];
    answer out;
    const char *twice = repeated(one, set);
    if (twice != NULL) {
        snprintf(wrong, sizeof wrong, "has a member \"%s\", which the answer adds: rename it", twice);
        answer_bad(one, one->line, wrong, set);
        return;
    }
    const char *why = lift(&out, one, frame, set);
    if (why != NULL)
        answer_bad(one, one->line, why, set);
    else
        write_answer(one, &out, set);
}
