/* 2D normalisation and distance matrix (section 3.1, eq. 1).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_EDM_H
#define EDML_EDM_H

#include "impute.h"

/* Half the height over the largest coordinate: below this, rounding of the coordinates destroys the
 * shape.  2^-12 leaves float32 12 bits. */
#define RESOLUTION REAL(0.000244140625)

/* The joints lie on a line when the narrow side of their spread is under 1/128 of the long side. */
#define THIN_SQUARED REAL(6.103515625e-5) /* 2^-14, its square */

static int on_a_line(const image_point at[EDML_JOINTS], uint16_t seen)
{
    const int count = count_seen(seen);
    real u = 0, v = 0; /* mean; joints that were not seen add nothing */
    for (int j = 0; j < EDML_JOINTS; j++) {
        u += at[j].u / (real)count;
        v += at[j].v / (real)count;
    }
    real uu = 0, uv = 0, vv = 0; /* uu <= max_aspect^2, vv <= 1 */
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!is_seen(seen, j)) continue;
        const real du = at[j].u - u, dv = at[j].v - v;
        uu += MUL(du, du) / EDML_JOINTS;
        uv += MUL(du, dv) / EDML_JOINTS;
        vv += MUL(dv, dv) / EDML_JOINTS;
    }
    return MUL(uu, vv) - MUL(uv, uv) <= MUL(MUL(THIN_SQUARED, uu + vv), uu + vv);
}

/* As edml_edm().  seen: seen_joints(in).  scratch: [MAX_IMPUTED * MAX_IMPUTED], for impute(); it may be
 * edm. */
static edml_status image_distances(real edm[EDML_PAIRS], const edml_keypoint in[EDML_JOINTS], uint16_t seen,
                                   int fewest_joints, real max_aspect, const edml_imputation *imputation,
                                   real *scratch)
{
    if (!are_finite(in, seen)) return EDML_ERR_NOT_FINITE;
    if (count_seen(seen) < fewest_joints) return EDML_ERR_TOO_FEW_JOINTS;
    if (imputation != NULL && count_seen(seen) < EDML_JOINTS - MAX_IMPUTED) return EDML_ERR_TOO_FEW_JOINTS;
    const image_box box = box_of(in, seen);
    if (box.half_height <= MUL(RESOLUTION, box.magnitude)) return EDML_ERR_DEGENERATE;
    if (box.half_width > MUL(max_aspect, box.half_height)) return EDML_ERR_ASPECT;
    image_point at[EDML_JOINTS] = {{0, 0}};
    for (int j = 0; j < EDML_JOINTS; j++)
        if (is_seen(seen, j)) at[j] = normalise(in[j], &box);
    if (on_a_line(at, seen)) return EDML_ERR_DEGENERATE;
    if (imputation != NULL) {
        if (!impute(at, seen, imputation, scratch)) return EDML_ERR_DEGENERATE;
        seen = ALL_JOINTS;
    }

    for (int i = 0; i < EDML_JOINTS; i++) {
        const uint16_t both = is_seen(seen, i) ? seen : 0; /* bit j: i and j are known */
        for (int j = i + 1; j < EDML_JOINTS; j++)
            *edm++ = is_seen(both, j) ? HYPOT(at[i].u - at[j].u, at[i].v - at[j].v) : 0;
    }
    return EDML_OK;
}

edml_status edml_edm(real edm[EDML_PAIRS], const edml_keypoint in[EDML_JOINTS], int fewest_joints,
                     real max_aspect, const edml_imputation *imputation)
{
    real scratch[MAX_IMPUTED * MAX_IMPUTED];
    if (edm == NULL || in == NULL) return EDML_ERR_ARGUMENT;
    return image_distances(edm, in, seen_joints(in), fewest_joints, max_aspect, imputation, scratch);
}

#endif
