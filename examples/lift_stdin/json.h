/* A strict scanner of JSON texts (RFC 8259, in UTF-8) that copies and allocates nothing.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef LIFT_STDIN_JSON_H
#define LIFT_STDIN_JSON_H

enum { JSON_DEPTH = 32 }; /* objects and arrays within each other */

/* The first character that is not white space. */
const char *json_skip(const char *p);

/* The end of the value that begins at p, or NULL if there is no value or one nested deeper than
 * `depth`.  Text ends with a zero byte. */
const char *json_value(const char *p, int depth);

/* For what json_value() found sound: the first element of an array or member of an object, and the
 * one behind that with the value at p; NULL if there is none. */
const char *json_first(const char *p);
const char *json_next(const char *p);

/* The value of the member at p, which is its name. */
const char *json_value_of(const char *p);

#endif
