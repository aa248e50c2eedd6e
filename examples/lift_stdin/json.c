/* A strict reader of JSON from a stream.
 *
 * SPDX-License-Identifier: MIT
 */
#include "json.h"

#include <string.h>

void json_start(json_input *in, FILE *file)
{
    in->file = file;
    in->ahead = JSON_NOT_READ;
    in->column_0 = 1;
    in->line = 1;
    in->fault = 0;
    json_forget(in, 0);
}

int json_peek(json_input *in)
{
    if (in->ahead == JSON_NOT_READ) in->ahead = getc(in->file);
    return in->ahead;
}

static void keep(json_input *in, int c)
{
    if (in->length < JSON_TEXT)
        in->text[in->length++] = (char)c;
    else
        in->too_long = 1;
}

static void drop(json_input *in)
{
    in->column_0 = json_peek(in) == '\n';
    in->line += in->column_0 ? 1U : 0U;
    in->ahead = JSON_NOT_READ;
}

void json_take(json_input *in)
{
    keep(in, json_peek(in));
    drop(in);
}

void json_forget(json_input *in, size_t length)
{
    in->length = length;
    in->too_long = 0;
}

const char *json_text(json_input *in)
{
    in->text[in->length] = '\0';
    return in->text;
}

static int is_white(int c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; }

int json_next(json_input *in)
{
    if (!is_white(json_peek(in))) return json_peek(in);
    while (is_white(json_peek(in))) drop(in);
    keep(in, ' ');
    return json_peek(in);
}

void json_skip_line(json_input *in)
{
    while (json_peek(in) != '\n' && json_peek(in) != EOF) drop(in);
    if (json_peek(in) == '\n') drop(in);
}

/* ---- Values ------------------------------------------------------------------------------------ */

static int wrong_here(json_input *in)
{
    in->fault = in->line;
    return 0;
}

static int is_digit(int c) { return c >= '0' && c <= '9'; }

static int is_hex(int c) { return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }

static int take_digits(json_input *in)
{
    if (!is_digit(json_peek(in))) return wrong_here(in);
    while (is_digit(json_peek(in))) json_take(in);
    return 1;
}

/* Takes a byte if it is this one. */
static int take_if(json_input *in, int c)
{
    if (json_peek(in) != c) return 0;
    json_take(in);
    return 1;
}

static int take_number(json_input *in)
{
    (void)take_if(in, '-');
    if (!take_if(in, '0') && !take_digits(in)) return 0;
    if (take_if(in, '.') && !take_digits(in)) return 0;
    if (!take_if(in, 'e') && !take_if(in, 'E')) return 1;
    if (!take_if(in, '+')) (void)take_if(in, '-');
    return take_digits(in);
}

/* An escape, from behind the backslash. */
static int take_escape(json_input *in)
{
    const int c = json_peek(in);
    if (c <= 0 || strchr("\"\\/bfnrtu", c) == NULL) return wrong_here(in);
    json_take(in);
    for (int n = 0; n < 4 && c == 'u'; n++) {
        if (!is_hex(json_peek(in))) return wrong_here(in);
        json_take(in);
    }
    return 1;
}

/* A character of UTF-8: in its shortest form, no surrogate, at most U+10FFFF. */
static int take_character(json_input *in)
{
    const int first = json_peek(in);
    if (first < 0x20 || (first >= 0x80 && first < 0xC2) || first > 0xF4)
        return wrong_here(in); /* also EOF */
    json_take(in);
    if (first < 0x80) return 1;
    const int second = json_peek(in);
    if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F)) return wrong_here(in);
    if ((first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F)) return wrong_here(in);
    for (int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : 1; more > 0; more--) {
        if (json_peek(in) < 0x80 || json_peek(in) > 0xBF) return wrong_here(in);
        json_take(in);
    }
    return 1;
}

static int take_string(json_input *in)
{
    if (!take_if(in, '"')) return wrong_here(in);
    while (!take_if(in, '"'))
        if (!(take_if(in, '\\') ? take_escape(in) : take_character(in))) return 0;
    return 1;
}

static int take_word(json_input *in, const char *word)
{
    for (; *word != '\0'; word++)
        if (!take_if(in, *word)) return wrong_here(in);
    return 1;
}

int json_name(json_input *in)
{
    if (!take_string(in)) return 0;
    if (json_next(in) != ':') return wrong_here(in);
    json_take(in);
    (void)json_next(in);
    return 1;
}

int json_more(json_input *in, char close)
{
    const int c = json_next(in);
    if (c != close && c != ',') return wrong_here(in) - 1;
    json_take(in);
    if (c == ',') (void)json_next(in);
    return c == ',';
}

/* An array or object, from its bracket on. */
static int take_nested(json_input *in, int depth)
{
    const char close = json_peek(in) == '{' ? '}' : ']';
    int more;
    if (depth == 0) return wrong_here(in);
    json_take(in);
    if (json_next(in) == close) return take_if(in, close);
    do {
        if (close == '}' && !json_name(in)) return 0;
        if (!json_value(in, depth - 1)) return 0;
    } while ((more = json_more(in, close)) > 0);
    return more == 0;
}

int json_value(json_input *in, int depth)
{
    switch (json_peek(in)) {
    case '{':
    case '[':
        return take_nested(in, depth);
    case '"':
        return take_string(in);
    case 't':
        return take_word(in, "true");
    case 'f':
        return take_word(in, "false");
    case 'n':
        return take_word(in, "null");
    default:
        return take_number(in);
    }
}

/* ---- In a text that was read ---------------------------------------------------------------------- */

static const char *skip_blanks(const char *p)
{
    while (*p == ' ') p++;
    return p;
}

static const char *skip_string(const char *p)
{
    for (p++; *p != '"'; p++)
        if (*p == '\\') p++;
    return p + 1;
}

const char *json_end(const char *p)
{
    int depth = 0;
    do {
        if (*p == '"') {
            p = skip_string(p);
        } else if (depth == 0 && *p != '[' && *p != '{') {
            p += strcspn(p, " ,]}");
        } else {
            depth += *p == '[' || *p == '{' ? 1 : *p == ']' || *p == '}' ? -1 : 0;
            p++;
        }
    } while (depth > 0);
    return p;
}

const char *json_first(const char *p)
{
    p = skip_blanks(p + 1);
    return *p == ']' || *p == '}' || *p == '\0' ? NULL : p;
}

const char *json_after(const char *p)
{
    p = skip_blanks(json_end(p));
    return *p == ',' ? skip_blanks(p + 1) : NULL;
}

const char *json_member(const char *p) { return skip_blanks(skip_blanks(skip_string(p)) + 1); }

static unsigned long hexadecimal(const char *p) /* four digits */
{
    unsigned long number = 0;
    for (int n = 0; n < 4; n++)
        number = number << 4 | (unsigned long)(is_digit(p[n]) ? p[n] - '0' : (p[n] | ' ') - 'a' + 10);
    return number;
}

/* The character at *p within a string, and moves *p behind it; END_OF_NAME at its end.  The two halves of a
 * surrogate pair are one. */
enum { END_OF_NAME = -1 };
static long take_from_name(const char **p)
{
    static const char letters[] = "\"\\/bfnrt", meant[] = "\"\\/\b\f\n\r\t";
    const unsigned char *at = (const unsigned char *)*p;
    if (*at == '"') return END_OF_NAME;
    if (*at == '\\' && at[1] != 'u') {
        *p += 2;
        return meant[strchr(letters, at[1]) - letters];
    }
    if (*at == '\\') {
        const unsigned long unit = hexadecimal(*p + 2);
        *p += 6;
        if (unit >> 10 != 0x36 || strncmp(*p, "\\u", 2) != 0 || hexadecimal(*p + 2) >> 10 != 0x37)
            return (long)unit;
        *p += 6;
        return (long)(0x10000 + ((unit & 0x3FF) << 10) + (hexadecimal(*p - 4) & 0x3FF));
    }
    const int more = *at >= 0xF0 ? 3 : *at >= 0xE0 ? 2 : *at >= 0xC0 ? 1 : 0;
    long character = more == 0 ? *at : *at & (0x3F >> more);
    for (int n = 1; n <= more; n++) character = character << 6 | (at[n] & 0x3F);
    *p += 1 + more;
    return character;
}

int json_is_named_as(const char *p, const char *like)
{
    long character;
    p++, like++;
    do {
        character = take_from_name(&p);
        if (take_from_name(&like) != character) return 0;
    } while (character != END_OF_NAME);
    return 1;
}

int json_is_named(const char *p, const char *name)
{
    for (p++; *name != '\0'; name++)
        if (*p == '"' || take_from_name(&p) != *name) return 0;
    return *p == '"';
}

int json_is_number(const char *p) { return *p == '-' || *p == 'n' || is_digit(*p); }
