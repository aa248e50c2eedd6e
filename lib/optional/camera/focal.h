/* The focal length of a camera, from many poses that it saw.
 *
 * People some metres away look nearly the same through all focal lengths, so that a pose says little, and poses of
 * one video all err alike: adding up their errors as if each said something of its own finds a focal length with
 * much confidence, and no better.  So evidence is their mean, and what cameras usually have counts as well.  The
 * result is the mean over the focal lengths, each weighted by about its probability.
 *
 * tools/evaluation/room.py measures it; the numbers below were chosen on training people.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FOCAL_H
#define EDML_FOCAL_H

#include <string.h>

#include "pnp.h"

#define MISFIT_ROOT REAL(54.77225575) /* root of 3000: squared errors over the body size to log-odds */
#define MAX_MISFIT REAL(4.0)          /* of a pose, so that none decides alone */
#define MAX_ERROR REAL(0.125)         /* an error over the body size; the misfit is of two below that */

/* (log of the focal length over 1.2)^2 / (2 0.5^2): how unlike a usual camera's it is */
static const real unusual[EDML_FOCAL_LENGTHS] = {
    REAL(1.532891), REAL(0.942368), REAL(0.494791), REAL(0.190157), REAL(0.028469), REAL(0.009725),
    REAL(0.133926), REAL(0.401072), REAL(0.811162), REAL(1.364197), REAL(2.060177), REAL(2.899101),
};

/* The mean |x| + |y| of the seen joints from their mean, over 4: sums of quarters of 16384 pixels. */
static pixels body_quarter(const edml_keypoint in[EDML_JOINTS])
{
    const pixels count = (pixels)count_seen(seen_joints(in));
    pixels x = 0, y = 0, size = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(in[j].c > 0)) continue;
        x += in[j].x / 4 / count;
        y += in[j].y / 4 / count;
    }
    for (int j = 0; j < EDML_JOINTS; j++)
        if (in[j].c > 0) size += (ABS(in[j].x / 4 - x) + ABS(in[j].y / 4 - y)) / count;
    return size;
}

/* Errors over the body size with each focal length, MAX_ERROR where there is no placement. */
static edml_status sweep_errors(real error[EDML_FOCAL_LENGTHS], const edml_focal *focal,
                                const edml_pose *pose, const edml_keypoint in[EDML_JOINTS], void *work,
                                size_t work_bytes)
{
    edml_status best = EDML_ERR_CAMERA;
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++) {
        edml_camera tried;
        edml_placement placed;
        error[n] = MAX_ERROR;
        if (!centred_camera(&tried, sweep_factor[n], focal->width, focal->height)) continue;
        const edml_status status = edml_place(&placed, pose, in, &tried, work, work_bytes);
        if (best != EDML_OK) best = status;
        if (status != EDML_OK) continue;
        const pixels size = body_quarter(in);
        if (placed.reprojection / 4 < MUL(MAX_ERROR, size)) error[n] = DIV(placed.reprojection / 4, size);
    }
    return best;
}

edml_status edml_focal_start(edml_focal *focal, pixels width, pixels height)
{
    if (focal == NULL) return EDML_ERR_ARGUMENT;
    if (!is_image_size(width, height)) return EDML_ERR_CAMERA;
    memset(focal, 0, sizeof *focal);
    focal->width = width;
    focal->height = height;
    return EDML_OK;
}

edml_status edml_focal_add(edml_focal *focal, const edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                           void *work, size_t work_bytes)
{
    if (focal == NULL || pose == NULL || in == NULL || work == NULL) return EDML_ERR_ARGUMENT;
    if (!EDML_IS_ALIGNED4(work)) return EDML_ERR_ARGUMENT;
    if (work_bytes < sizeof(edml_work)) return EDML_ERR_WORK_TOO_SMALL;
    if (!is_image_size(focal->width, focal->height)) return EDML_ERR_CAMERA;
    real error[EDML_FOCAL_LENGTHS], least = MAX_ERROR;
    const edml_status status = sweep_errors(error, focal, pose, in, work, work_bytes);
    if (status != EDML_OK) return status;
    if (focal->poses < UINT16_MAX) focal->poses++;
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++)
        if (error[n] < least) least = error[n];
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++) {
        const real a = MUL(MISFIT_ROOT, error[n] - least), b = MUL(MISFIT_ROOT, error[n] + least);
        const real misfit = MUL(a, b), before = FROM_API(focal->misfit[n]); /* <= 6.9 * 13.7 */
        const real news = (misfit < MAX_MISFIT ? misfit : MAX_MISFIT) - before;
        focal->misfit[n] = TO_API(before + news / (real)(int)focal->poses);
    }
    return EDML_OK;
}

/* About exp(-x), for 0 <= x: (1 + x / 8)^-8 */
static real likelihood(real x)
{
    const real root = DIV(REAL(1.0), REAL(1.0) + x / 8), square = SQUARE(root),
               fourth = SQUARE(square);
    return SQUARE(fourth);
}

/* The mean factor, each weighted by its likelihood. */
static real expected_factor(const edml_focal *focal)
{
    real least = 2 * MAX_MISFIT, sum = 0, mean = 0; /* nothing is beyond 4 + 2.9 */
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++) {
        const real unlike = FROM_API(focal->misfit[n]) + unusual[n];
        if (unlike < least) least = unlike;
    }
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++) {
        const real weight = likelihood(FROM_API(focal->misfit[n]) + unusual[n] - least);
        sum += weight; /* 1 to 12 */
        mean += (real)n * weight;
    }
    mean = DIV(mean, sum); /* of their numbers, because their logarithms are evenly spaced */
    int below = 0;
    while (below < EDML_FOCAL_LENGTHS - 2 && mean >= REAL(1.0)) {
        mean -= REAL(1.0);
        below++;
    }
    return sweep_factor[below] + MUL(mean, sweep_factor[below + 1] - sweep_factor[below]);
}

edml_status edml_focal_camera(edml_camera *camera, const edml_focal *focal)
{
    if (camera == NULL || focal == NULL) return EDML_ERR_ARGUMENT;
    if (focal->poses == 0 || !is_image_size(focal->width, focal->height)) return EDML_ERR_CAMERA;
    edml_camera found;
    if (!centred_camera(&found, expected_factor(focal), focal->width, focal->height))
        return EDML_ERR_CAMERA;
    *camera = found;
    return EDML_OK;
}

#endif
