/* Any bytes into the JSON scanner of lift_stdin: it stays in the text, and what it calls sound it can
 * walk, to the same end.  fuzz_json [COUNT]
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "json.h"

static void require(int holds, const char *what)
{
    if (holds) return;
    fprintf(stderr, "fuzz_json: %s\n", what);
    abort();
}

/* Walks what is sound; returns where it ends. */
static const char *walk(const char *p, int depth)
{
    require(depth >= 0, "nested too deeply");
    const char *end = json_value(p, JSON_DEPTH);
    require(end != NULL && end > p, "a part of a sound value is not sound");
    if (*p != '[' && *p != '{') return end;
    const char *last = p + 1, close = *p == '[' ? ']' : '}';
    const int members = *p == '{';
    for (p = json_first(p); p != NULL; p = json_next(p)) {
        if (members) {
            require(*p == '"', "a member without a name");
            p = json_value_of(p);
            require(p != NULL, "a member without a value");
        }
        last = walk(p, depth - 1);
    }
    require(*json_skip(last) == close && json_skip(last) + 1 == end, "a walk to another end");
    return end;
}

/* The text on the heap, exactly as long as it is, so that the sanitizer sees a step beyond. */
static int check(const char *text, size_t length)
{
    char *copy = malloc(length + 1);
    require(copy != NULL, "no memory");
    memcpy(copy, text, length);
    copy[length] = '\0';
    const char *end = json_value(copy, JSON_DEPTH);
    const int sound = end != NULL;
    if (sound) {
        require(end <= copy + strlen(copy), "an end beyond the text");
        walk(copy, JSON_DEPTH);
    }
    free(copy);
    return sound;
}

int main(int argc, char **argv)
{
    static const char seed[] =
        "{\"id\":7,\"keypoints\":[[1.5,-2e3,0.9],[0,1],null,[null,null]],"
        "\"t\":{\"a\":[true,false,[]],\"b\":\"\\u00e9\\n\xC3\xA9\xF0\x9F\x98\x80\"}} ";
    static const char letters[] = "{}[]\",:\\0-1.e+ntu a\xC3\xA9\xED\xF4\xFF\x01";
    const int count = argc > 1 ? atoi(argv[1]) : 200000;
    uint32_t state = 1;
    int sound = 0;
    require(check(seed, sizeof seed - 1), "the seed is sound");
    for (int n = 0; n < count; n++) {
        char text[sizeof seed];
        memcpy(text, seed, sizeof seed);
        state = state * 1664525U + 1013904223U;
        const size_t length = state % 4 ? sizeof seed - 1 : (state >> 8) % sizeof seed;
        for (int edits = 1 + (int)(state >> 28); edits > 0; edits--) {
            state = state * 1664525U + 1013904223U;
            const uint32_t place = (state >> 8) % (sizeof seed - 1), letter = state >> 24;
            text[place] = letters[letter % (sizeof letters - 1)];
        }
        sound += check(text, length);
    }
    require(sound > count / 1000 && sound < count, "one kind of text only");
    printf("%d texts, %d sound\n", count, sound);
    return 0;
}
