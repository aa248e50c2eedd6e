/* edml_adapt() and edml_adapt_many() of any keypoints in any format, the library's and others.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS adapt
#include "../native.h"

enum { KEYPOINTS = 33 };

static uint8_t draw_index(choices *from, int keypoints)
{
    return (uint8_t)(draw_one_in(from, 8) ? EDML_NO_KEYPOINT : draw_below(from, (uint32_t)keypoints));
}

static edml_format draw_format(choices *from)
{
    int known = 0;
    while (edml_formats[known] != NULL) known++;
    edml_format format = *edml_formats[draw_below(from, (uint32_t)known)];
    if (!draw_one_in(from, 4)) return format;
    format.keypoints = (uint8_t)(1 + draw_below(from, KEYPOINTS));
    for (int j = 0; j < EDML_JOINTS - 2; j++) format.limb[j] = draw_index(from, format.keypoints);
    for (int n = 0; n < 2; n++) format.ears[n] = draw_index(from, format.keypoints);
    for (int n = 0; n < 3; n++) format.face[n] = draw_index(from, format.keypoints);
    format.crown = draw_index(from, format.keypoints);
    format.centre = draw_index(from, format.keypoints);
    return format;
}

/* Someone's joints, and about as many other keypoints near their head. */
static void draw_keypoints(edml_keypoint in[KEYPOINTS], choices *from)
{
    sighting all[3 * EDML_JOINTS];
    draw_frame(all, from);
    draw_frame(all + EDML_JOINTS, from);
    for (int k = 2 * EDML_JOINTS; k < KEYPOINTS; k++) {
        all[k] = all[draw_below(from, 2 * EDML_JOINTS)];
        if (draw_one_in(from, 4)) all[k].x += draw_between(from, -50, 50);
    }
    to_keypoints(in, all, KEYPOINTS);
}

static int is_number(edml_keypoint p)
{
    return IS_FINITE(p.c) && (!(p.c > 0) || (IS_FINITE(p.x) && IS_FINITE(p.y)));
}

static int is_same(edml_keypoint a, edml_keypoint b)
{
    return memcmp(&a.x, &b.x, sizeof a.x) == 0 && memcmp(&a.y, &b.y, sizeof a.y) == 0 &&
           memcmp(&a.c, &b.c, sizeof a.c) == 0;
}

static void check_limbs(const edml_keypoint out[EDML_JOINTS], const edml_keypoint in[],
                        const edml_format *format)
{
    const edml_keypoint none = {0, 0, 0};
    for (int j = EDML_R_SHOULDER; j < EDML_JOINTS; j++) {
        const uint8_t k = format->limb[j - EDML_R_SHOULDER];
        REQUIRE(is_same(out[j], k == EDML_NO_KEYPOINT ? none : in[k]), "a limb is no copy");
    }
}

/* Of the shoulders' confidences head and neck have no more than half the lower one.  Shoulders that are no numbers
 * pass through, if there is anything to guess by. */
static void check_guess(edml_keypoint guess, edml_keypoint right, edml_keypoint left)
{
    const confidence lower = right.c < left.c ? right.c : left.c;
    if (!is_number(right) || !is_number(left)) {
        REQUIRE(!is_number(guess) || guess.c == 0, "what is no number does not pass through");
    } else if (!(lower > 0)) {
        REQUIRE(guess.c == 0, "guessed without a shoulder");
    } else if (is_number(guess)) {
        REQUIRE(guess.c >= 0 && guess.c <= lower - lower / 2, "too sure of a guess");
    }
}

/* Right and left are treated alike. */
static void check_mirror(const edml_keypoint out[EDML_JOINTS], const edml_keypoint in[], edml_format format)
{
    edml_keypoint mirrored[KEYPOINTS], found[EDML_JOINTS];
    const edml_format plain = format;
    for (int k = 0; k < KEYPOINTS; k++) {
        mirrored[k] = in[k];
        mirrored[k].x = (pixels)(IS_FINITE(in[k].x) ? -in[k].x : in[k].x);
    }
    for (int j = EDML_R_SHOULDER; j < EDML_JOINTS; j++)
        format.limb[j - EDML_R_SHOULDER] = plain.limb[edml_mirror_joint[j] - EDML_R_SHOULDER];
    format.ears[0] = plain.ears[1];
    format.ears[1] = plain.ears[0];
    format.face[0] = plain.face[1];
    format.face[1] = plain.face[0];
    edml_adapt(found, mirrored, &format);
    for (int j = 0; j <= EDML_NECK_BASE; j++) {
        if (!is_number(out[j]) || !is_number(found[j])) {
            REQUIRE(is_number(out[j]) == is_number(found[j]), "a mirror image of something else");
            continue;
        }
        const double x = from_pixels(out[j].x) + from_pixels(found[j].x);
        const double y = from_pixels(out[j].y) - from_pixels(found[j].y), most = IS_EXACT ? 0 : 2.0 / 65536;
        REQUIRE(fabs(x) <= most && fabs(y) <= most && out[j].c == found[j].c,
                "another head of a mirror image");
    }
}

/* Many at once are as many one by one. */
static void check_many(const edml_keypoint in[KEYPOINTS], const edml_format *format)
{
    edml_keypoint out[KEYPOINTS][EDML_JOINTS], alone[EDML_JOINTS];
    const int count = KEYPOINTS / format->keypoints;
    memset(out, 0, sizeof out);
    edml_adapt_many(out[0], in, count, format);
    for (int n = 0; n < count; n++) {
        memset(alone, 0, sizeof alone);
        edml_adapt(alone, in + n * format->keypoints, format);
        for (int j = 0; j < EDML_JOINTS; j++)
            REQUIRE(is_same(out[n][j], alone[j]), "one of many is not as alone");
    }
}

void FUZZ_TARGET(adapt)(choices *from)
{
    edml_keypoint in[KEYPOINTS], out[EDML_JOINTS];
    const edml_format format = draw_format(from);
    draw_keypoints(in, from);
    memset(out, 0, sizeof out);
    edml_adapt(out, in, &format);
    check_limbs(out, in, &format);
    for (int j = 0; j <= EDML_NECK_BASE; j++)
        check_guess(out[j], out[EDML_R_SHOULDER], out[EDML_L_SHOULDER]);
    check_mirror(out, in, format);
    if (draw_one_in(from, 8)) check_many(in, &format);
#ifdef EDML_FUZZ_Q
    edml_keypoint watched[EDML_JOINTS];
    checked_tally taken;
    if (!fuzz_watches) return;
    checked_adapt(watched, in, &format, &taken);
    REQUIRE(taken.overflows == 0, "a number overflows");
    for (int j = 0; j < EDML_JOINTS; j++)
        REQUIRE(is_same(out[j], watched[j]), "not what watched numbers give");
#endif
}
