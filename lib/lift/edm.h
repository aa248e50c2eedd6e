/* The matrix of distances in the image (eq. 1).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_EDM_H
#define EDML_EDM_H

#include "../api/api.h"

void edml_edm(real edm[EDML_PAIRS], const edml_image *image)
{
    const edml_image_point *const last = image->at + EDML_JOINTS - 1;
    for (const edml_image_point *at = image->at; at < last; at++) {
        const edml_image_point p = *at, *q = at; /* no distance changes p */
        do {
            q++;
            *edm++ = HYPOT(p.u - q->u, p.v - q->v); /* |u|, |v| <= 7.8: distances up to 11.1 */
        } while (q < last);
    }
}

#endif
