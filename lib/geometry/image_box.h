/* The box around the seen joints in the image, and coordinates in it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_IMAGE_BOX_H
#define EDML_IMAGE_BOX_H

#include "seen.h"

/* Its centre, half its size, and the largest |coordinate|. */
typedef struct {
    pixels x, y, half_width, half_height, magnitude;
} image_box;

static image_box box_of(const edml_keypoint in[], uint16_t seen)
{
    int j = 0;
    while (j < EDML_JOINTS - 1 && !is_seen(seen, j)) j++; /* the first one */
    pixels left = in[j].x, right = left, top = in[j].y, bottom = top;
    for (j++; j < EDML_JOINTS; j++) {
        if (!is_seen(seen, j)) continue;
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
    box.magnitude = MIN_MAGNITUDE;
    if (box.magnitude < -left) box.magnitude = -left;
    if (box.magnitude < right) box.magnitude = right;
    if (box.magnitude < -top) box.magnitude = -top;
    if (box.magnitude < bottom) box.magnitude = bottom;
    return box;
}

/* A joint in the box's coordinates, half its longer side being 1: |u|, |v| <= 1. */
static edml_image_point normalise(edml_keypoint in, const image_box *box)
{
    edml_image_point at = {0, 0};
    const pixels half = box->half_height > box->half_width ? box->half_height : box->half_width;
    ASSUME(half >= 4096); /* 2^-12 of 256 pixels: smaller boxes are refused */
    /* within the box, whose middle is up to two units off */
    at.u = DIV_TO(REAL(1.0005), in.x - box->x, half);
    at.v = DIV_TO(REAL(1.0005), in.y - box->y, half);
    return at;
}

#endif
