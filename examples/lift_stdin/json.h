/* A strict reader of JSON (RFC 8259, in UTF-8) from a stream: byte by byte, in constant memory.  What it reads is
 * checked and kept as text; the functions at the end walk through such a text.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef LIFT_STDIN_JSON_H
#define LIFT_STDIN_JSON_H

#include <stddef.h>
#include <stdio.h>

#ifndef JSON_TEXT       /* the fuzzers have fewer, so as to get there */
#define JSON_TEXT 65536 /* bytes that are kept */
#endif
enum { JSON_DEPTH = 32 }; /* objects and arrays within each other */
enum { JSON_NOT_READ = -2 };

typedef struct {
    FILE *file;
    int ahead;           /* the next byte, EOF, or JSON_NOT_READ: no byte is read before it is wanted */
    int column_0;        /* the next byte is the first of its line */
    unsigned long line;  /* of the next byte, from 1 */
    unsigned long fault; /* where json_value() and the others failed */
    size_t length;       /* of the text that is kept */
    int too_long;        /* and some that is not */
    char text[JSON_TEXT + 2];
} json_input;

void json_start(json_input *in, FILE *file);

/* The next byte, which stays there, or EOF; json_next(): behind white space, which is kept as one blank. */
int json_peek(json_input *in);
int json_next(json_input *in);

/* Takes the next byte, and keeps it. */
void json_take(json_input *in);

/* Keeps no more than the first `length` bytes of the text. */
void json_forget(json_input *in, size_t length);

/* The text that is kept, ended by a zero byte. */
const char *json_text(json_input *in);

/* Reads the value that begins at the next byte, or, up to its value, a member of an object.  Returns 0 for
 * anything but JSON, and for values nested deeper than `depth`. */
int json_value(json_input *in, int depth);
int json_name(json_input *in);

/* Reads on behind an element or member: 1: a comma, and there is another; 0: the end; -1: neither. */
int json_more(json_input *in, char close);

/* Skips the rest of the line. */
void json_skip_line(json_input *in);

/* ---- In a text that was read ---------------------------------------------------------------------- */

/* The first element of an array or member of an object, and the one behind that with the value at p; NULL if
 * there is none.  The bracket at its end may be missing. */
const char *json_first(const char *p);
const char *json_after(const char *p);

/* Behind the value at p. */
const char *json_end(const char *p);

/* The value of the member at p, which is its name. */
const char *json_member(const char *p);

/* Is this the name of the member at p, or do two members have the same, however they are escaped?  `name` is in
 * ASCII. */
int json_is_named(const char *p, const char *name);
int json_is_named_as(const char *p, const char *like);

/* Is it a number, or null? */
int json_is_number(const char *p);

#endif
