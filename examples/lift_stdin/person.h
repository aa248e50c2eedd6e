/* A person of JSON: its answer.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef LIFT_STDIN_PERSON_H
#define LIFT_STDIN_PERSON_H

#include "lift_stdin.h"

/* Names of members that hold a person's keypoints, and of those that hold people. */
extern const char *const person_names[], *const people_names[];

/* Which of the names, which end with NULL, the member at p has; -1: none of them. */
int name_among(const char *p, const char *const names[]);

/* A person as JSON has it. */
typedef struct {
    unsigned long line; /* where it begins */
    const char *head;   /* an object, open at its end: the frame's members that the answer repeats */
    const char *text;   /* its own; NULL: nobody */
    int bare;           /* that is a set of keypoints, not an object with one */
    int listed;         /* it is an element of an array */
} json_person;

/* People of an array are of one frame as long as this is the same: a hash of their frame's number, 0 if they have
 * none. */
uint64_t frame_of(const json_person *one);

/* Lifts and answers it, or answers that nobody is there; `frame` is counted from 0. */
void answer_person(const json_person *one, unsigned long frame, const options *set);

/* Is it a list of people that are sets of keypoints, in an object's member?  Returns the list, and in *member the member;
 * or NULL. */
const char *list_of_sets(const char *object, const char **member);
int has_scores(const char *object); /* apart from the keypoints */

/* Says what is wrong, and answers with a bad line; `one` may be NULL. */
void answer_bad(const json_person *one, unsigned long line, const char *wrong, const options *set);

#endif
