/* The image in the body's frame: turned, moved and scaled to the body (section 3.1 scales it alone).
 *
 * What a network reads is then the same however the camera is rolled, for people who lie and who stand on
 * their hands.  Missing joints are imputed first, because the body's axis may need them.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_BODY_FRAME_H
#define EDML_BODY_FRAME_H

#include "../geometry/image_box.h"
#include "impute.h"

/* Half the box's longer side over the largest coordinate: below this, rounding of the coordinates destroys
 * the shape.  2^-12 leaves float32 12 bits. */
#define RESOLUTION REAL(0.000244140625)

/* The joints lie on a line when the narrow side of their spread is under 1/128 of the long side. */
#define THIN_SQUARED REAL(6.103515625e-5) /* 2^-14, its square */

#define WIDEST REAL(3.5)       /* of seen joints, from their mean across the axis */
#define FARTHEST REAL(3.9)     /* of any, on either axis: imputed ones are clamped to it */
#define NO_AXIS REAL(0.000977) /* shorter, the body's axis has no direction in the image */

static int on_a_line(const edml_image_point at[EDML_JOINTS], uint16_t seen)
{
    const real count = (real)count_seen(seen);
    const int joints = EDML_JOINTS;
    real u = 0, v = 0; /* mean; joints that were not seen add nothing */
    for (int j = 0; j < EDML_JOINTS; j++) {
        u += at[j].u;
        v += at[j].v;
    }
    u /= count;
    v /= count;
    real uu = 0, uv = 0, vv = 0; /* <= 14, then <= 1 */
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!is_seen(seen, j)) continue;
        const real du = at[j].u - u, dv = at[j].v - v;
        uu += SQUARE(du);
        uv += MUL(du, dv);
        vv += SQUARE(dv);
    }
    uu /= (real)joints;
    uv /= (real)joints;
    vv /= (real)joints;
    return MUL(uu, vv) - SQUARE(uv) <= MUL(MUL(THIN_SQUARED, uu + vv), uu + vv);
}

/* NaN -> -limit, which no imputation gives */
static real clamp_real(real a, real limit) { return a < limit ? (a > -limit ? a : -limit) : limit; }

static EDML_NOINLINE void clamp_point(edml_image_point *p)
{
    p->u = clamp_real(p->u, FARTHEST);
    p->v = clamp_real(p->v, FARTHEST);
}

static edml_image_point image_middle(edml_image_point a, edml_image_point b)
{
    const edml_image_point middle = {(a.u + b.u) / 2, (a.v + b.v) / 2};
    return middle;
}

/* The body's axis, from the middle of head, neck and shoulders to that of the hips: a unit vector. */
static edml_image_point body_axis(const edml_image_point at[EDML_JOINTS])
{
    const edml_image_point shoulders = image_middle(at[EDML_R_SHOULDER], at[EDML_L_SHOULDER]);
    const edml_image_point upper = image_middle(image_middle(at[EDML_HEAD], at[EDML_NECK_BASE]), shoulders);
    const edml_image_point hips = image_middle(at[EDML_R_HIP], at[EDML_L_HIP]);
    const real u = hips.u - upper.u, v = hips.v - upper.v, length = HYPOT(u, v);
    edml_image_point axis = {0, REAL(1.0)};
    if (length > NO_AXIS) {
        axis.u = DIV_TO(REAL(1.0), u, length); /* no component is longer than the vector */
        axis.v = DIV_TO(REAL(1.0), v, length);
    }
    return axis;
}

/* Turns joints so that `down` points down.  |out| <= 5.6.  Written as two sums, because gcc 12 would make one
 * fused instruction of a sum and a difference side by side, even where contraction is off. */
static void turn_down(edml_image_point at[EDML_JOINTS], edml_image_point down)
{
    const real minus_u = -down.u;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_image_point p = at[j];
        at[j].u = MUL(down.v, p.u) + MUL(minus_u, p.v);
        at[j].v = MUL(down.u, p.u) + MUL(down.v, p.v);
    }
}

/* Moves the origin to the mean across the axis, of the joints in `known`, and to the middle of the seen ones
 * along it; scales.  The other joints stay at the origin.  Two seen joints are 2 or more apart, so that
 * half >= 0.27. */
static void centre_and_scale(edml_image *image, uint16_t known)
{
    real mean = 0, top = FARTHEST + FARTHEST, bottom = -FARTHEST - FARTHEST, reach = 0;
    for (int j = 0; j < EDML_JOINTS; j++) mean += image->at[j].u; /* <= 5.6 each; 0 of the others */
    mean /= (real)count_seen(known);
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!is_seen(image->seen, j)) continue;
        const edml_image_point p = image->at[j];
        if (p.v < top) top = p.v;
        if (p.v > bottom) bottom = p.v;
        if (ABS(p.u - mean) > reach) reach = ABS(p.u - mean);
    }
    const real middle = (top + bottom) / 2, high = (bottom - top) / 2;
    const real half = MUL(high, WIDEST) > reach ? high : DIV(reach, WIDEST);
    ASSUME(half >= REAL(0.27)); /* two seen joints are 2 or more apart */
    const real scale = DIV(REAL(1.0), half); /* |u - mean| <= 11.2 */
    ASSERT(scale <= REAL(3.71));
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!is_seen(known, j)) continue;
        edml_image_point *const at = &image->at[j];
        at->u = MUL(scale, at->u - mean);
        at->v = MUL(scale, at->v - middle);
        if (!is_seen(image->seen, j)) clamp_point(at);
        /* a seen joint is within WIDEST across and 1 along, another is clamped */
        ASSUME(WITHIN(at->u, FARTHEST) && WITHIN(at->v, FARTHEST));
    }
}

/* As edml_body_frame().  scratch: [MAX_IMPUTED * MAX_IMPUTED], for impute(). */
static edml_status to_body_frame(edml_image *image, const edml_keypoint in[EDML_JOINTS], int fewest_joints,
                                 const edml_imputation *imputation, real *scratch)
{
    const edml_image_point origin = {0, 0}, down = {0, REAL(1.0)};
    const uint16_t seen = seen_joints(in);
    const int count = count_seen(seen);
    if (!are_finite(in, seen)) return EDML_ERR_NOT_FINITE;
    if (count < fewest_joints) return EDML_ERR_TOO_FEW_JOINTS;
    if (imputation != NULL && count + MAX_IMPUTED < EDML_JOINTS) return EDML_ERR_TOO_FEW_JOINTS;
    const image_box box = box_of(in, seen);
    if (box.half_height <= MUL(RESOLUTION, box.magnitude) &&
        box.half_width <= MUL(RESOLUTION, box.magnitude))
        return EDML_ERR_DEGENERATE;
    edml_image_point *const at = image->at;
    image->down = down;
    image->seen = seen;
    for (int j = 0; j < EDML_JOINTS; j++) at[j] = is_seen(seen, j) ? normalise(in[j], &box) : origin;
    if (on_a_line(at, seen)) return EDML_ERR_DEGENERATE;
    if (imputation != NULL) {
        if (count < EDML_JOINTS) {
            if (!impute(at, seen, imputation, scratch)) return EDML_ERR_DEGENERATE;
            for (int j = 0; j < EDML_JOINTS; j++)
                if (!is_seen(seen, j)) clamp_point(&at[j]);
        }
        image->down = body_axis(at);
        turn_down(at, image->down);
    }
    centre_and_scale(image, imputation != NULL ? ALL_JOINTS : seen);
    return EDML_OK;
}

edml_status edml_body_frame(edml_image *image, const edml_keypoint in[EDML_JOINTS], int fewest_joints,
                            const edml_imputation *imputation)
{
    real scratch[MAX_IMPUTED * MAX_IMPUTED];
    edml_image framed;
    if (image == NULL || in == NULL) return EDML_ERR_ARGUMENT;
    const edml_status status = to_body_frame(&framed, in, fewest_joints, imputation, scratch);
    if (status == EDML_OK) *image = framed;
    return status;
}

#endif
