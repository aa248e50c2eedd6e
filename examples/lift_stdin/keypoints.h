/* Keypoints: what JSON and lines of numbers have of a person.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef LIFT_STDIN_KEYPOINTS_H
#define LIFT_STDIN_KEYPOINTS_H

#include "lift_stdin.h"

/* A keypoint of 2 or 3 numbers x, y and confidence, as far as it was seen: NaN says that it was not. */
edml_keypoint keypoint_of(const float *numbers, int count, float threshold);

/* Exchanges the first two numbers of a keypoint where the format has y before x. */
void order_axes(float *numbers, const options *set);

/* Takes `count` numbers for all keypoints, two or three each, one behind another.  Returns NULL, or says that there
 * are more or fewer. */
const char *take_numbers(edml_keypoint out[], float *numbers, int count, const options *set);

/* What to try with so many keypoints, or so many numbers: begins with a semicolon, or is empty. */
const char *formats_with(int count, int are_numbers);

/* Which keypoint of the format, or which joint, has this name, in whatever case; -1: none. */
int keypoint_named(const char *text, size_t length, const options *set);
const char *name_of_keypoint(int index, const options *set); /* NULL: the names are not known */

/* Of sound JSON: is this a keypoint, that is an array of 2 or 3 numbers or an object with x?  And is this array a set
 * of keypoints? */
int is_keypoint(const char *text);
int is_set(const char *array);
int is_set_of_columns(const char *object);

/* Reads a set of keypoints and, if they stand apart, their scores (else NULL).  Returns NULL or what is wrong. */
const char *read_set(edml_keypoint out[], const char *text, const char *scores, const options *set);

#endif
