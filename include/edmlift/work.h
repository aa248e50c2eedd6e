/* Work memory of a lift.  Make it static, because it is large for a task's stack.  Its contents mean
 * nothing between calls, and its members are not part of the interface.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDMLIFT_WORK_H
#define EDMLIFT_WORK_H

#include "../edmlift.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct { /* a joint in the body's frame: edml_body_frame() of stages.h */
    float u, v;
} edml_image_point;

typedef struct {
    edml_image_point at[EDML_JOINTS], down;
    uint16_t seen;
} edml_image;

typedef struct { /* what a network says: edml_predict() */
    float distance[EDML_PAIRS], share[EDML_JOINTS];
    edml_point x[EDML_JOINTS];
} edml_prediction;

typedef struct { /* of two axes */
    float cosine, sine;
} edml_plane_rotation;

typedef struct { /* of the network */
    union { /* what is not needed at the same time, here and below */
        float values[196];
        int32_t integers[196];
    } io;
    union {
        float layer[192]; /* no fully connected layer has more */
        int16_t layers[2][192];
        int32_t list[196]; /* of what the last layer reads, on some processors */
    } units;
} edml_network_work;

typedef struct { /* of what follows it; the prediction is where the network's inputs and outputs are not */
    union {
        struct {
            float gram[91];
            union {
                struct {
                    float band[27];
                    edml_plane_rotation rotation[66];
                } tridiagonal;
                float vector[169];
            } by;
        } mds;
        edml_point step[4][EDML_JOINTS];
    } stage;
    edml_prediction prediction;
} edml_points_work;

typedef struct {
    edml_image image;
    edml_point x[EDML_JOINTS];
    union {
        edml_network_work network;
        edml_points_work points;
    } of;
} edml_work;

typedef struct {
    edml_work lift;
    float more_units[4273];
} edml_fconv_work; /* with FConv: 19 KB */

#ifdef __cplusplus
}
#endif

#endif
