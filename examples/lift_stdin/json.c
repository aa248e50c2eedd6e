/* A strict scanner of JSON texts.
 *
 * SPDX-License-Identifier: MIT
 */
#include "json.h"

#include <stddef.h>
#include <string.h>

static int is_digit(char c) { return c >= '0' && c <= '9'; }

static int is_hex(char c) { return is_digit(c) || (c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F'); }

const char *json_skip(const char *p)
{
    while (*p == ' ' || *p == '\t' || *p == '\r' || *p == '\n') p++;
    return p;
}

static const char *skip_digits(const char *p)
{
    if (!is_digit(*p)) return NULL;
    while (is_digit(*p)) p++;
    return p;
}

static const char *skip_number(const char *p)
{
    if (*p == '-') p++;
    p = *p == '0' ? p + 1 : skip_digits(p);
    if (p != NULL && *p == '.') p = skip_digits(p + 1);
    if (p == NULL || (*p != 'e' && *p != 'E')) return p;
    p++;
    return skip_digits(*p == '+' || *p == '-' ? p + 1 : p);
}

/* An escape, from behind the backslash. */
static const char *skip_escape(const char *p)
{
    if (*p == '\0') return NULL;
    if (*p != 'u') return strchr("\"\\/bfnrt", *p) != NULL ? p + 1 : NULL;
    for (int n = 1; n <= 4; n++)
        if (!is_hex(p[n])) return NULL;
    return p + 5;
}

/* A character of UTF-8: in its shortest form, no surrogate, at most U+10FFFF. */
static const char *skip_character(const char *p)
{
    const unsigned char first = (unsigned char)p[0];
    if (first < 0x80) return first >= 0x20 ? p + 1 : NULL; /* also at the end of the text */
    if (first < 0xC2 || first > 0xF4) return NULL;
    const unsigned char second = (unsigned char)p[1];
    const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : 1;
    if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F)) return NULL;
    if ((first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F)) return NULL;
    for (int n = 1; n <= more; n++)
        if (((unsigned char)p[n] & 0xC0) != 0x80) return NULL; /* also the zero byte */
    return p + more + 1;
}

/* A string, from behind its quotation mark. */
static const char *skip_string(const char *p)
{
    while (p != NULL && *p != '"') p = *p == '\\' ? skip_escape(p + 1) : skip_character(p);
    return p != NULL ? p + 1 : NULL;
}

static const char *skip_word(const char *p, const char *word)
{
    const size_t length = strlen(word);
    return strncmp(p, word, length) == 0 ? p + length : NULL;
}

/* Skips a name and its colon, up to the value. */
static const char *skip_name(const char *p)
{
    if (*p != '"' || (p = skip_string(p + 1)) == NULL) return NULL;
    p = json_skip(p);
    return *p == ':' ? json_skip(p + 1) : NULL;
}

/* An array or object, from its bracket on. */
static const char *skip_nested(const char *p, int depth)
{
    const char close = *p == '{' ? '}' : ']';
    if (depth == 0) return NULL;
    p = json_skip(p + 1);
    if (*p == close) return p + 1;
    for (;;) {
        if (close == '}' && (p = skip_name(p)) == NULL) return NULL;
        if ((p = json_value(p, depth - 1)) == NULL) return NULL;
        p = json_skip(p);
        if (*p == close) return p + 1;
        if (*p != ',') return NULL;
        p = json_skip(p + 1);
    }
}

const char *json_value(const char *p, int depth)
{
    switch (*p) {
    case '{':
    case '[':
        return skip_nested(p, depth);
    case '"':
        return skip_string(p + 1);
    case 't':
        return skip_word(p, "true");
    case 'f':
        return skip_word(p, "false");
    case 'n':
        return skip_word(p, "null");
    default:
        return skip_number(p);
    }
}

const char *json_first(const char *p)
{
    p = json_skip(p + 1);
    return *p == ']' || *p == '}' ? NULL : p;
}

const char *json_next(const char *p)
{
    p = json_skip(json_value(p, JSON_DEPTH));
    return *p == ',' ? json_skip(p + 1) : NULL;
}

const char *json_value_of(const char *p) { return skip_name(p); }
