/* edmlift.h in integers: for cores without an FPU.  No float instruction, and the same bits on every
 * processor.
 *
 * A Q16 number is an int32_t with 16 fraction bits: 65536 is 1, and a pixel is 65536.  edmlift.h has the
 * meaning of each type and function, under its name without `_q`.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDMLIFT_FIXED_H
#define EDMLIFT_FIXED_H

#include "../edmlift.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    int32_t x, y; /* pixels, Q16, y down; -2^29 < x, y < 2^29 (8192 pixels) */
    int16_t c;    /* confidence, 32767 is 1; c <= 0: the joint was not seen */
} edml_keypoint_q;

typedef struct {
    int32_t x, y, z; /* Q16 */
} edml_point_q;

typedef struct {
    edml_point_q joint[EDML_JOINTS]; /* metres, Q16 */
    int32_t misfit;                  /* metres, Q16 */
    uint16_t seen;
} edml_pose_q;

void edml_adapt_q(edml_keypoint_q out[EDML_JOINTS], const edml_keypoint_q in[],
                  const edml_format *format);

typedef struct {
    int32_t x, y, z; /* metres, Q24: 24 fraction bits */
} edml_point_q24;

typedef struct {
    int32_t u, v; /* Q24 */
} edml_image_point_q;

typedef struct {
    edml_image_point_q at[EDML_JOINTS], down;
    uint16_t seen;
} edml_image_q;

typedef struct { /* Q24 */
    int32_t distance[EDML_PAIRS], share[EDML_JOINTS];
    edml_point_q24 x[EDML_JOINTS];
} edml_prediction_q;

typedef struct { /* Q24 */
    int32_t cosine, sine;
} edml_plane_rotation_q;

/* Work memory of a lift, as edml_work. */
typedef struct {
    struct {
        int32_t values[196];
    } io;
    union {
        int16_t layers[2][192]; /* no fully connected layer has more */
        int32_t list[196];      /* of what the last layer reads, on some processors */
    } units;
} edml_network_work_q;

typedef struct {
    union {
        struct {
            int32_t gram[91];
            union {
                struct {
                    int32_t band[27];
                    edml_plane_rotation_q rotation[66];
                } tridiagonal;
                int32_t vector[169];
            } by;
        } mds;
        edml_point_q24 step[4][EDML_JOINTS];
    } stage;
    edml_prediction_q prediction;
} edml_points_work_q;

typedef struct {
    edml_image_q image;
    edml_point_q24 x[EDML_JOINTS];
    union {
        edml_network_work_q network;
        edml_points_work_q points;
    } of;
} edml_work_q;

typedef struct { /* of a lift with FConv: 11 KB */
    edml_work_q lift;
    int32_t more_units[2193];
} edml_fconv_work_q;

size_t edml_model_work_bytes_q(const edml_model *model); /* for edml_lift_q(); 0: not for that lift */

/* edml_lift() in integers.  It runs the quantised models, those with 16-bit and 8-bit weights.
 *   up  in any unit, each component within 2^29
 *   EDML_ERR_NOT_FINITE  also: a coordinate at or beyond the ends of its range, where a saturating
 *                        conversion puts infinity
 *   EDML_ERR_DEGENERATE  also: a person under 1/8 pixel tall
 *   EDML_ERR_MODEL       a float model */
edml_status edml_lift_q(edml_pose_q *pose, const edml_keypoint_q in[EDML_JOINTS], const edml_point_q *up,
                        const edml_model *model, void *work, size_t work_bytes);

#ifdef __cplusplus
}
#endif

#endif
