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
        in[j].x = is_seen(seen, j) ? Frama_C_interval(1 - (1 << 29), (1 << 29) - 1) : INT32_MIN;
        in[j].y = is_seen(seen, j) ? Frama_C_interval(1 - (1 << 29), (1 << 29) - 1) : INT32_MIN;
        in[j].c = (int16_t)(is_seen(seen, j) ? Frama_C_interval(1, INT16_MAX) : Frama_C_interval(INT16_MIN, 0));
    }
    const edml_status status = to_body_frame(&image, in, FEWEST, &edml_default_imputation, scratch);
    if (status != EDML_OK) return;
    for (int j = 0; j < EDML_JOINTS; j++)
        ASSERT(WITHIN(image.at[j].u, FARTHEST) && WITHIN(image.at[j].v, FARTHEST));
    ASSERT(WITHIN(image.down.u, REAL(1.0) + 1) && WITHIN(image.down.v, REAL(1.0) + 1));
}

int main(void)
{
    for_sizes(with_set);
    return 0;
}
