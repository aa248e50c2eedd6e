/* From keypoints to the body's frame: with any keypoints of the documented range.  Imputation has a
 * program of its own.
 *
 * SPDX-License-Identifier: MIT
 */
#include "sets.h"

#include "lift/body_frame.h"

static void with_set(uint16_t seen)
{
    static edml_keypoint in[EDML_JOINTS];
    static edml_image image;
    static real scratch[MAX_IMPUTED * MAX_IMPUTED];
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = some_pixels(is_seen(seen, j));
        in[j].y = some_pixels(is_seen(seen, j));
        in[j].c = some_confidence(is_seen(seen, j));
    }
    const edml_status status = to_body_frame(&image, in, FEWEST, &edml_default_imputation, scratch);
    if (status != EDML_OK) return;
    for (int j = 0; j < EDML_JOINTS; j++)
        ASSERT(WITHIN(image.at[j].u, FARTHEST) && WITHIN(image.at[j].v, FARTHEST));
    ASSERT(WITHIN(image.down.u, REAL(1.0) + 1) && WITHIN(image.down.v, REAL(1.0) + 1));
}

int main(void)
{
    for_sizes(with_set, FEWEST);
    return 0;
}
