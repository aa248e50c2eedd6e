/* Many people in one call.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_MANY_H
#define EDML_MANY_H

#include "../api/api.h"

int edml_lift_many(edml_pose poses[], edml_status status[], const edml_keypoint in[], const edml_point up[],
                   const edml_camera *camera, int count, const edml_model *model, void *work,
                   size_t work_bytes)
{
    if (poses == NULL || status == NULL || in == NULL || count < 0) return -1;
    int lifted = 0;
    for (int n = 0; n < count; n++, in += EDML_JOINTS) {
        const edml_point *const above = up == NULL ? NULL : &up[n];
        status[n] = camera == NULL
                        ? edml_lift(&poses[n], in, above, model, work, work_bytes)
                        : edml_lift_with_camera(&poses[n], in, above, camera, model, work, work_bytes);
        lifted += status[n] == EDML_OK;
    }
    return lifted;
}

void edml_adapt_many(edml_keypoint out[], const edml_keypoint in[], int count, const edml_format *format)
{
    for (int n = 0; n < count; n++, out += EDML_JOINTS, in += format->keypoints)
        edml_adapt(out, in, format);
}

#endif
