/* Many people in one call, for programs that have them at hand, such as bindings of other languages.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDMLIFT_MANY_H
#define EDMLIFT_MANY_H

#include "camera.h"

#ifdef __cplusplus
extern "C" {
#endif

/* edml_lift() of `count` people, one after the other; the same bits.  Threads may share the arrays, each with
 * its part of the people and work memory of its own.  At most 1.2 KB of stack.
 *   poses, status  [count]; a pose is written where its status is EDML_OK
 *   in             [count][EDML_JOINTS]
 *   up             [count], or NULL
 *   camera         of all, by which edml_lift_with_camera() lifts them; or NULL
 * Returns how many were lifted; -1, and writes nothing, if an array is missing or count < 0. */
int edml_lift_many(edml_pose poses[], edml_status status[], const edml_keypoint in[], const edml_point up[],
                   const edml_camera *camera, int count, const edml_model *model, void *work,
                   size_t work_bytes);

int edml_lift_many_q(edml_pose_q poses[], edml_status status[], const edml_keypoint_q in[],
                     const edml_point_q up[], const edml_camera_q *camera, int count,
                     const edml_model *model, void *work, size_t work_bytes);

/* edml_adapt() of `count` people, one after the other; nothing if count < 0.
 *   out  [count][EDML_JOINTS]
 *   in   [count][format->keypoints] */
void edml_adapt_many(edml_keypoint out[], const edml_keypoint in[], int count, const edml_format *format);
void edml_adapt_many_q(edml_keypoint_q out[], const edml_keypoint_q in[], int count,
                       const edml_format *format);

#ifdef __cplusplus
}
#endif

#endif
