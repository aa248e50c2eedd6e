/* The matrix of distances in the image (eq. 1).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_EDM_H
#define EDML_EDM_H

#include "../api/api.h"

void edml_edm(real edm[EDML_PAIRS], const edml_image *image)
{
    const edml_image_point *at = image->at;
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = i + 1; j < EDML_JOINTS; j++) /* |u|, |v| <= 7.8: distances up to 11.1 */
            *edm++ = HYPOT(at[i].u - at[j].u, at[i].v - at[j].v);
}

#endif
