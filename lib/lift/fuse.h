/* Fuses two measurements of each joint's x and y: the pose's and the image's.
 *
 * The image is scaled to the pose.  Each of its joints is moved to where it would be seen at the mean
 * depth, for a person at the distance that was usual in training.  The image's weight in the mean is
 * weight / (1 + square / misfit^2), where square is the mean squared difference of pose and image: the more
 * they differ, the more noise the image is likely to have.  Training fits weight, misfit and distance along
 * with the network.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FUSE_H
#define EDML_FUSE_H

#include "../geometry/centre.h"
#include "../geometry/image_box.h"
#include "../network/model.h"

/* edml_model's fusion: weight misfit^2, misfit^2, 1 / distance. */
enum { FUSION_WEIGHT, FUSION_SQUARE, FUSION_NEARNESS };

/* Half the image of the seen joints, at their mean depth; means of pose and image, of their squares and
 * products.  |u|, |v| <= 3.75, because the pose is within 3 m of its mean and 1 / nearness is at least
 * that. */
typedef struct {
    image_point at[EDML_JOINTS], at_mean;
    point mean;
    real xx, xu, uu; /* about the means: <= 9, 12 and 15 */
} fusion_sums;

static EDML_NOINLINE void sum_fusion(fusion_sums *o, const point x[EDML_JOINTS],
                                     const edml_keypoint in[EDML_JOINTS], uint16_t seen, real nearness)
{
    const image_box box = box_of(in, seen);
    const real weight = REAL(1.0) / (real)count_seen(seen);
    real u = 0, v = 0, xx = 0, xu = 0, uu = 0;
    o->mean = mean_joint(x, seen);
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!is_seen(seen, j)) continue;
        const real half = REAL(0.5) + MUL(nearness, x[j].z - o->mean.z) / 2; /* 0 to 1 */
        image_point at = normalise(in[j], &box);
        at.u = MUL(half, at.u);
        at.v = MUL(half, at.v);
        u += MUL(weight, at.u);
        v += MUL(weight, at.v);
        xx += MUL(weight, MUL(x[j].x, x[j].x) + MUL(x[j].y, x[j].y));
        xu += MUL(weight, MUL(x[j].x, at.u) + MUL(x[j].y, at.v));
        uu += MUL(weight, MUL(at.u, at.u) + MUL(at.v, at.v));
        o->at[j] = at;
    }
    o->at_mean.u = u;
    o->at_mean.v = v;
    o->xx = xx - MUL(o->mean.x, o->mean.x) - MUL(o->mean.y, o->mean.y);
    o->xu = xu - MUL(o->mean.x, u) - MUL(o->mean.y, v);
    o->uu = uu - MUL(u, u) - MUL(v, v);
}

static void move_to_image(point x[EDML_JOINTS], const fusion_sums *o, uint16_t seen,
                          const edml_model *model)
{
    const real scale = DIV(o->xu, o->uu);          /* < 64 */
    const real square = o->xx - MUL(scale, o->xu); /* scale xu <= xx */
    const real weight = DIV(PARAM(model->fusion[FUSION_WEIGHT]),
                            PARAM(model->fusion[FUSION_SQUARE]) + (square > 0 ? square : 0)); /* <= 1 */
    const real u = MUL(scale, o->at_mean.u) - o->mean.x; /* scale at: <= sqrt(14 * 9), about its mean */
    const real v = MUL(scale, o->at_mean.v) - o->mean.y;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!is_seen(seen, j)) continue;
        x[j].x += MUL(weight, MUL(scale, o->at[j].u) - x[j].x - u);
        x[j].y += MUL(weight, MUL(scale, o->at[j].v) - x[j].y - v);
    }
}

void edml_fuse(point x[EDML_JOINTS], const edml_keypoint in[EDML_JOINTS], uint16_t seen,
               const edml_model *model)
{
    fusion_sums o;
    seen = (uint16_t)(seen & ALL_JOINTS);
    if (seen != 0) {
        sum_fusion(&o, x, in, seen, PARAM(model->fusion[FUSION_NEARNESS]));
        if (o.xu > 0 && o.uu > o.xu / 64) move_to_image(x, &o, seen, model);
    }
    move_origin_to_mid_hip(x);
}

#endif
