/* 2D normalisation and distance matrix (section 3.1, eq. 1).
 *
 * SPDX-License-Identifier: MIT
 */

/* Below this share of the largest coordinate a person is too small for the shape to survive the
 * coordinates' rounding: 2^-12 leaves float32 12 bits. */
#define RESOLUTION REAL(0.000244140625)

/* The joints lie on a line when the narrow side of their spread is under 1/128 of the long side. */
#define THIN REAL(6.103515625e-5) /* 2^-14, its square */

/* Box around the seen joints: its centre, half its size, and the largest |coordinate|. */
typedef struct {
    pixels x, y, half_width, half_height, magnitude;
} image_box;

static image_box box_of(const keypoint in[], uint16_t seen)
{
    int j = 0;
    while (j < EDML_JOINTS - 1 && !(seen >> j & 1)) j++; /* the first one */
    pixels left = in[j].x, right = left, top = in[j].y, bottom = top;
    for (j++; j < EDML_JOINTS; j++) {
        if (!(seen >> j & 1)) continue;
        if (in[j].x < left) left = in[j].x;
        if (in[j].x > right) right = in[j].x;
        if (in[j].y < top) top = in[j].y;
        if (in[j].y > bottom) bottom = in[j].y;
    }
    image_box box; /* halves first: the sum of two coordinates may overflow */
    box.x = left / 2 + right / 2;
    box.y = top / 2 + bottom / 2;
    box.half_width = right / 2 - left / 2;
    box.half_height = bottom / 2 - top / 2;
    box.magnitude = EXACT_TO;
    if (box.magnitude < -left) box.magnitude = -left;
    if (box.magnitude < right) box.magnitude = right;
    if (box.magnitude < -top) box.magnitude = -top;
    if (box.magnitude < bottom) box.magnitude = bottom;
    return box;
}

/* A joint in the box's coordinates, half its height being 1: |u| <= widest, |v| <= 1.  In a flat box,
 * at its centre. */
static image_point normalise(keypoint in, const image_box *box)
{
    image_point at = {0, 0};
    if (!(box->half_height > 0)) return at;
    at.u = DIV(in.x - box->x, box->half_height);
    at.v = DIV(in.y - box->y, box->half_height);
    return at;
}

static int on_a_line(const image_point at[EDML_JOINTS], uint16_t seen)
{
    const int count = count_bits(seen);
    real u = 0, v = 0; /* mean; joints that were not seen add nothing */
    for (int j = 0; j < EDML_JOINTS; j++) {
        u += at[j].u / (real)count;
        v += at[j].v / (real)count;
    }
    real uu = 0, uv = 0, vv = 0; /* uu <= widest^2, vv <= 1 */
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(seen >> j & 1)) continue;
        const real du = at[j].u - u, dv = at[j].v - v;
        uu += MUL(du, du) / EDML_JOINTS;
        uv += MUL(du, dv) / EDML_JOINTS;
        vv += MUL(dv, dv) / EDML_JOINTS;
    }
    return MUL(uu, vv) - MUL(uv, uv) <= MUL(MUL(THIN, uu + vv), uu + vv);
}

edml_status NAME(edml_edm)(real edm[EDML_PAIRS], const keypoint in[EDML_JOINTS], int fewest,
                           real widest, const edml_completion *completion)
{
    if (edm == NULL || in == NULL) return EDML_ERR_ARGUMENT;
    uint16_t seen = seen_joints(in);
    if (!all_finite(in, seen)) return EDML_ERR_NOT_FINITE;
    if (count_bits(seen) < fewest) return EDML_ERR_TOO_FEW_JOINTS;
    if (completion != NULL && count_bits(seen) < EDML_JOINTS - MOST_GUESSED)
        return EDML_ERR_TOO_FEW_JOINTS;
    const image_box box = box_of(in, seen);
    if (box.half_height <= MUL(RESOLUTION, box.magnitude)) return EDML_ERR_DEGENERATE;
    if (box.half_width > MUL(widest, box.half_height)) return EDML_ERR_UNUSUAL;
    image_point at[EDML_JOINTS] = {{0, 0}};
    for (int j = 0; j < EDML_JOINTS; j++)
        if (seen >> j & 1) at[j] = normalise(in[j], &box);
    if (on_a_line(at, seen)) return EDML_ERR_DEGENERATE;
    if (completion != NULL) {
        if (!complete(at, seen, completion, edm)) return EDML_ERR_DEGENERATE;
        seen = ALL_JOINTS;
    }

    for (int i = 0; i < EDML_JOINTS; i++) {
        const uint16_t both = seen >> i & 1 ? seen : 0; /* bit j: i and j are known */
        for (int j = i + 1; j < EDML_JOINTS; j++)
            *edm++ = both >> j & 1 ? HYPOT(at[i].u - at[j].u, at[i].v - at[j].v) : 0;
    }
    return EDML_OK;
}
