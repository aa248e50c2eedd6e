/* edml_body_frame() and edml_edm() of any frame.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS body_frame
#include "../native.h"

enum { CAUSES = ALLOW(EDML_ERR_NOT_FINITE) | ALLOW(EDML_ERR_TOO_FEW_JOINTS) | ALLOW(EDML_ERR_DEGENERATE) };

static void check_image(const edml_image *image, uint16_t seen, int is_turned)
{
    const double u = from_real(image->down.u), v = from_real(image->down.v);
    double top = 9, bottom = -9;
    REQUIRE(image->seen == seen, "another seen mask");
    const double rounding = IS_EXACT ? 4 * TINY : 2e-4; /* of an axis of a thousandth */
    REQUIRE(fabs(hypot(u, v) - 1) <= rounding && (is_turned || v == 1), "no axis of the body");
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double at_u = from_real(image->at[j].u), at_v = from_real(image->at[j].v);
        REQUIRE(fabs(at_u) <= 3.9 + TINY && fabs(at_v) <= 3.9 + TINY, "a joint is beyond the frame");
        if (!(seen >> j & 1)) continue;
        REQUIRE(fabs(at_u) <= 3.5 + 16 * TINY && fabs(at_v) <= 1 + 16 * TINY,
                "a seen joint is beyond the frame");
        top = fmin(top, at_v);
        bottom = fmax(bottom, at_v);
    }
    REQUIRE(fabs(top + bottom) <= 64 * TINY, "the middle is not the origin");
}

static void check_distances(const edml_image *image)
{
    real edm[EDML_PAIRS];
    edml_edm(edm, image);
    for (int i = 0; i < EDML_JOINTS; i++) {
        for (int j = i + 1; j < EDML_JOINTS; j++) {
            const double wanted = hypot(from_real(image->at[i].u) - from_real(image->at[j].u),
                                        from_real(image->at[i].v) - from_real(image->at[j].v));
            const double found = from_real(edm[EDML_PAIR(i, j)]);
            REQUIRE(found >= 0 && found <= 11.1 && fabs(found - wanted) <= 4 * TINY, "another distance");
        }
    }
}

/* Weights of a covariance, as an imputation's are: those of a few made-up joints. */
static const edml_imputation *draw_imputation(choices *from)
{
    static edml_imputation singular;
    const uint32_t kind = draw_below(from, 16);
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = 0; j < EDML_JOINTS; j++)
            singular.weight[i][j] = (int16_t)(i == j ? 0 : EDML_IMPUTATION_ONE / (EDML_JOINTS - 1));
    return kind < 12 ? &edml_default_imputation : kind == 12 ? &singular : NULL;
}

void FUZZ_TARGET(body_frame)(choices *from)
{
    sighting frame[EDML_JOINTS];
    edml_keypoint in[EDML_JOINTS];
    edml_image image;
    snapshot before;
    const int fewest = 1 + (int)draw_below(from, 14);
    const edml_imputation *imputation = draw_imputation(from);
    draw_frame(frame, from);
    for (uint32_t n = draw_below(from, 16); n < 8; n++) frame[draw_below(from, EDML_JOINTS)].c = 0;
    to_keypoints(in, frame, EDML_JOINTS);
    memset(&image, 0xA5, sizeof image);
    take_snapshot(&before, &image, sizeof image);
    const edml_status status = edml_body_frame(&image, in, fewest, imputation);
#ifdef EDML_FUZZ_Q
    edml_image watched;
    memset(&watched, 0xA5, sizeof watched);
    WATCH(status, checked_body_frame(&watched, in, fewest, imputation, &taken), &image, &watched,
          offsetof(edml_image, seen));
#endif
    if (!check_status(status, CAUSES, &before)) return;
    check_image(&image, seen_of(in), imputation != NULL);
    check_distances(&image);
}
