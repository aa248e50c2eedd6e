/* Takes the place of lib/api/api_q.h: the stage texts of lib/ in integers that watch themselves.  Each text
 * that says edml_lift defines edml_lift_checked here.
 *
 * Poses and points that are given or returned stay plain integers; what is computed with them does not.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_API_H
#define EDML_API_H

#include "real_checked.h"

extern "C" {
#include "network/model.h"
#include "optional/joint_limit_maps.h"
}

struct point {
    real x, y, z;
};
typedef real pixels;
typedef int16_t confidence;
typedef int32_t api_real;

#define TO_API(a) (((a) + 128).value() >> 8)
#define FROM_API(a) (real(a) * 256)
#define NO_ANGLE EDML_NO_ANGLE
#define IS_FINITE(a) checked_range(a)
#define MAX_PIXELS real((1 << 29) - 1)
#define API_MAX INT32_MAX
#define MAX_SLOPE (32 << 16)
#define MIN_MAGNITUDE (256 << 16)
#define PIXELS(n) real((n) * 65536)
#define PARAM(number) real((number).q24)
#define WORK_BYTES(model) ((model)->work_bytes_q != 0 ? sizeof(edml_work) : 0)
#define RUN_NETWORK checked_network
#define SCALE(model) checked_scaling(model)

static inline bool checked_range(int32_t a) { return -(1 << 29) < a && a < 1 << 29; }
static inline bool checked_range(real a) { return checked_range(a.value()); }
template <typename T> bool checked_range(T) = delete; /* nothing that would be narrowed */
template <> inline bool checked_range(int16_t a) { return checked_range(int32_t{a}); }

/* ---- Types with such numbers ---- */

struct edml_keypoint_checked {
    pixels x, y;
    confidence c;
};

struct edml_image_point_checked {
    real u, v;
};

struct edml_image_checked {
    edml_image_point_checked at[EDML_JOINTS], down;
    uint16_t seen;
};

struct edml_prediction_checked {
    real distance[EDML_PAIRS], share[EDML_JOINTS];
    point x[EDML_JOINTS];
};

struct edml_camera_checked {
    pixels fx, fy, cx, cy;
};

struct edml_placement_checked {
    edml_point_q joint[EDML_JOINTS], rotation[3], translation;
    pixels reprojection;
    uint16_t steps;
};

struct edml_focal_checked {
    pixels width, height;
    api_real misfit[EDML_FOCAL_LENGTHS];
    uint16_t poses;
};

struct edml_moving_checked {
    point at, rate;
};

struct edml_tracked_joint_checked {
    edml_moving_checked image, space;
    real innovation_x, innovation_y;
    uint16_t age;
};

struct edml_track_checked { /* as edml_track_q */
    edml_smoothing_q smooth_image, smooth_space;
    int32_t noise_full;
    real jitter, image_step, space_step;
    uint32_t elapsed;
    uint16_t held;
    uint8_t swapped, mirrored, leapt, started;
    uint16_t aside;
    uint32_t time;
    real arms_log_odds, legs_log_odds, mirror_log_odds;
    edml_tracked_joint_checked joint[EDML_JOINTS];
};

struct edml_matrix_checked {
    real at[EDML_JOINTS][EDML_JOINTS];
};

struct edml_plane_rotation_checked {
    real cosine, sine;
};

struct edml_eigen_checked {
    real value[EDML_JOINTS], vector[EDML_JOINTS][EDML_JOINTS];
    edml_matrix_checked diagonal;
};

struct edml_work_checked { /* with structures for the unions of edml_work_q */
    edml_image_checked image;
    point x[EDML_JOINTS];
    struct {
        struct {
            struct {
                real values[196];
            } io;
        } network;
        struct {
            struct {
                struct {
                    real gram[91];
                    struct {
                        struct {
                            real band[27];
                            edml_plane_rotation_checked rotation[66];
                        } tridiagonal;
                        real vector[169];
                    } by;
                } mds;
                point step[4][EDML_JOINTS];
            } stage;
            edml_prediction_checked prediction;
        } points;
    } of;
};

/* The network has integers of its own, and the exporter proves their ranges. */
static inline void checked_network(const edml_model *model, edml_work_checked *work)
{
    static edml_fconv_work_q memory;
    int32_t *values = memory.lift.of.network.io.values;
    for (int k = 0; k < model->inputs; k++) values[k] = work->of.network.io.values[k].value();
    edml__run_network_q(model, &memory);
    for (int k = 0; k < edml__output_values(model); k++) work->of.network.io.values[k] = values[k];
}

typedef edml_status checked_scale(edml_work_checked *work, const edml_model *model);
extern checked_scale *checked_scaling(const edml_model *model); /* that for scale_q */

/* ---- Names, as in api_q.h ---- */

#define edml_keypoint edml_keypoint_checked
#define edml_point edml_point_q
#define edml_pose edml_pose_q
#define edml_work edml_work_checked
#define edml_image edml_image_checked
#define edml_image_point edml_image_point_checked
#define edml_prediction edml_prediction_checked
#define edml_camera edml_camera_checked
#define edml_placement edml_placement_checked
#define edml_body edml_body_q
#define edml_measured_body edml_measured_body_q
#define edml_path edml_path_q
#define edml_focal edml_focal_checked
#define edml_smoothing edml_smoothing_q
#define edml_moving edml_moving_checked
#define edml_tracked_joint edml_tracked_joint_checked
#define edml_track edml_track_checked
#define edml_matrix edml_matrix_checked
#define edml_eigen edml_eigen_checked
#define edml_plane_rotation edml_plane_rotation_checked

#define edml_adapt edml_adapt_checked
#define edml_body_frame edml_body_frame_checked
#define edml_edm edml_edm_checked
#define edml_predict edml_predict_checked
#define edml_jacobi edml_jacobi_checked
#define edml_mds edml_mds_checked
#define edml_refine edml_refine_checked
#define edml_stress edml_stress_checked
#define edml_mirror edml_mirror_checked
#define edml_align edml_align_checked
#define edml_orient edml_orient_checked
#define edml_fuse edml_fuse_checked
#define edml__scale_and_align edml__scale_and_align_checked
#define edml__scale_and_orient edml__scale_and_orient_checked
#define edml_lift edml_lift_checked
#define edml_lift_with_camera edml_lift_with_camera_checked
#define edml_track_start edml_track_start_checked
#define edml_track_lift edml_track_lift_checked
#define edml_track_distance edml_track_distance_checked
#define edml_track_swap_sides edml_track_swap_sides_checked
#define edml_place edml_place_checked
#define edml_place_sweep edml_place_sweep_checked
#define edml_path_start edml_path_start_checked
#define edml_path_follow edml_path_follow_checked
#define edml_focal_start edml_focal_start_checked
#define edml_focal_add edml_focal_add_checked
#define edml_focal_camera edml_focal_camera_checked
#define edml_fit_body edml_fit_body_checked
#define edml_measure_start edml_measure_start_checked
#define edml_measure_body edml_measure_body_checked
#define edml_quality edml_quality_checked
#define edml_stand edml_stand_checked
#define edml_angles edml_angles_checked
#define edml_joint_limits edml_joint_limits_checked
#define edml_reflect_by_joint_limits edml_reflect_by_joint_limits_checked

/* ---- Ways in ---- */

edml_status edml_lift(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_point *up,
                      const edml_model *model, void *work, size_t work_bytes); /* lift.cpp */

/* Keypoints as these texts have them. */
struct checked_keypoints {
    edml_keypoint_checked joint[33]; /* as many as any format has */
    checked_keypoints(const edml_keypoint_q in[], int count)
    {
        for (int n = 0; n < count; n++) {
            joint[n].x = in[n].x;
            joint[n].y = in[n].y;
            joint[n].c = in[n].c;
        }
    }
};

#endif
