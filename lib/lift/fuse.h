/* Fuses two measurements of each joint's x and y: the network's and the image's.
 *
 * The image is scaled to the points.  Each of its joints is moved to where it would be seen at the mean
 * depth, for a person at the distance that was usual in training.  The image's weight in the mean is
 * share / (1 + square / misfit^2), where square is the mean squared difference of points and image: the more
 * they differ, the more noise the image is likely to have.  The network gives each joint its share; training
 * fits misfit and distance along with it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FUSE_H
#define EDML_FUSE_H

#include "../geometry/centre.h"
#include "../network/model.h"

/* Half the image of the seen joints, at their mean depth; means of points and image, of their squares and
 * products.  Points are at most 6 m from their mean on each axis, and 1 / nearness is at least 3 m, so that
 * |u|, |v| <= 5.25. */
typedef struct {
    edml_image_point at[EDML_JOINTS], at_mean;
    point mean;
    real xx, xu, uu; /* about the means: <= 72, 63 and 56 */
} fusion_sums;

static EDML_NOINLINE void sum_fusion(fusion_sums *o, const point x[EDML_JOINTS], const edml_image *image,
                                     real nearness)
{
    const real weight = REAL(1.0) / (real)count_seen(image->seen);
    real u = 0, v = 0, xx = 0, xu = 0, uu = 0;
    o->mean = mean_joint(x, image->seen);
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!is_seen(image->seen, j)) continue;
        const real away = x[j].z - o->mean.z;
        ASSUME(WITHIN(away, REAL(6.0))); /* no two are farther apart */
        const real half = REAL(0.5) + MUL(nearness, away) / 2;
        ASSERT(-REAL(0.501) <= half && half <= REAL(1.501));
        const edml_image_point at = {MUL(half, image->at[j].u), MUL(half, image->at[j].v)};
        u += MUL(weight, at.u);
        v += MUL(weight, at.v);
        xx += MUL(weight, SQUARE(x[j].x) + SQUARE(x[j].y));
        xu += MUL(weight, MUL(x[j].x, at.u) + MUL(x[j].y, at.v));
        uu += MUL(weight, SQUARE(at.u) + SQUARE(at.v));
        o->at[j] = at;
    }
    o->at_mean.u = u;
    o->at_mean.v = v;
    o->xx = xx - SQUARE(o->mean.x) - SQUARE(o->mean.y);
    ASSUME(o->xx >= -REAL(0.001)); /* a variance, but for rounding */
    o->xu = xu - MUL(o->mean.x, u);
    /* a covariance across and a mean product along, each within 6 x 5.9 */
    ASSUME(WITHIN(o->xu, REAL(71.0)));
    o->xu -= MUL(o->mean.y, v);
    o->uu = uu - SQUARE(u) - SQUARE(v);
}

/* square: of the difference, a mean over the seen joints. */
static void move_to_image(point x[EDML_JOINTS], const fusion_sums *o, uint16_t seen, real scale,
                          real square, const real share[EDML_JOINTS], const edml_model *model)
{
    const real usual = PARAM(model->fusion[FUSION_SQUARE]);
    const real weight = DIV_TO(REAL(1.0), usual, usual + square); /* one of its parts */
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!is_seen(seen, j)) continue;
        const real part = MUL(share[j], weight);
        /* The squares of scale at, about its mean, have a mean of 72 at most: each is <= sqrt(14 * 72). */
        x[j].x += MUL(part, MUL_TO(REAL(31.75), scale, o->at[j].u - o->at_mean.u) - (x[j].x - o->mean.x));
        x[j].y += MUL(part, MUL_TO(REAL(31.75), scale, o->at[j].v - o->at_mean.v) - (x[j].y - o->mean.y));
    }
}

real edml_fuse(point x[EDML_JOINTS], const edml_image *image, const real share[EDML_JOINTS],
               const edml_model *model)
{
    fusion_sums o;
    if ((image->seen & ALL_JOINTS) == 0) return 0;
    sum_fusion(&o, x, image, PARAM(model->fusion[FUSION_NEARNESS]));
    if (!(o.xu > 0 && o.uu > o.xu / 64)) return o.xx > 0 ? SQRT(o.xx) : 0;
    const real scale = DIV_TO(REAL(64.0), o.xu, o.uu);             /* as uu > xu / 64 */
    const real square = o.xx - MUL_TO(REAL(72.0), scale, o.xu); /* scale xu <= xx */
    const real difference = square > 0 ? square : 0;
    move_to_image(x, &o, image->seen, scale, difference, share, model);
    return SQRT(difference);
}

#endif
