/* Where a joint lies across the camera's axis is measured twice, by the pose and by the image: their
 * weighted mean.
 *
 * The image is brought to the pose's scale, and each of its joints to where it would be seen at the
 * depth of their middle, for a person at the distance that was usual in training.  Its weight is
 * share / (1 + square / misfit^2), square being the mean square of what pose and image disagree by:
 * the more they do, the more noise there is likely to be in the image.  tools/train.py trains share,
 * misfit and distance along with the network.
 *
 * SPDX-License-Identifier: MIT
 */

/* edml_model's blend: share misfit^2, misfit^2, 1 / distance. */
enum { BLEND_SHARE, BLEND_SQUARE, BLEND_NEARNESS };

/* Of the seen joints: the pose and half the image, the latter at the depth of all; means of them and of
 * their squares and products.  |u|, |v| <= 3.75, for the pose is within 3 m of its mean, and 1 / nearness
 * at least that. */
typedef struct {
    image_point at[EDML_JOINTS], at_mean;
    point mean;
    real xx, xu, uu; /* about the means: <= 9, 12 and 15 */
} overlay;

static EDML_APART void lay_over(overlay *o, const point x[EDML_JOINTS], const keypoint in[EDML_JOINTS],
                                uint16_t seen, real nearness)
{
    const image_box box = box_of(in, seen);
    const real part = REAL(1.0) / (real)count_bits(seen);
    real u = 0, v = 0, xx = 0, xu = 0, uu = 0;
    o->mean = mean_of(x, seen);
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(seen >> j & 1)) continue;
        const real half = REAL(0.5) + MUL(nearness, x[j].z - o->mean.z) / 2; /* 0 to 1 */
        image_point at = normalise(in[j], &box);
        at.u = MUL(half, at.u);
        at.v = MUL(half, at.v);
        u += MUL(part, at.u);
        v += MUL(part, at.v);
        xx += MUL(part, MUL(x[j].x, x[j].x) + MUL(x[j].y, x[j].y));
        xu += MUL(part, MUL(x[j].x, at.u) + MUL(x[j].y, at.v));
        uu += MUL(part, MUL(at.u, at.u) + MUL(at.v, at.v));
        o->at[j] = at;
    }
    o->at_mean.u = u;
    o->at_mean.v = v;
    o->xx = xx - MUL(o->mean.x, o->mean.x) - MUL(o->mean.y, o->mean.y);
    o->xu = xu - MUL(o->mean.x, u) - MUL(o->mean.y, v);
    o->uu = uu - MUL(u, u) - MUL(v, v);
}

static void move_to_image(point x[EDML_JOINTS], const overlay *o, uint16_t seen, const edml_model *model)
{
    const real scale = DIV(o->xu, o->uu);          /* < 64 */
    const real square = o->xx - MUL(scale, o->xu); /* scale xu <= xx */
    const real part = DIV(SETTING(model->blend[BLEND_SHARE]),
                          SETTING(model->blend[BLEND_SQUARE]) + (square > 0 ? square : 0)); /* <= 1 */
    const real u = MUL(scale, o->at_mean.u) - o->mean.x; /* scale at: <= sqrt(14 * 9), about its mean */
    const real v = MUL(scale, o->at_mean.v) - o->mean.y;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (!(seen >> j & 1)) continue;
        x[j].x += MUL(part, MUL(scale, o->at[j].u) - x[j].x - u);
        x[j].y += MUL(part, MUL(scale, o->at[j].v) - x[j].y - v);
    }
}

void NAME(edml_blend)(point x[EDML_JOINTS], const keypoint in[EDML_JOINTS], uint16_t seen,
                      const edml_model *model)
{
    overlay o;
    seen = (uint16_t)(seen & ALL_JOINTS);
    if (seen != 0) {
        lay_over(&o, x, in, seen, SETTING(model->blend[BLEND_NEARNESS]));
        if (o.xu > 0 && o.uu > o.xu / 64) move_to_image(x, &o, seen, model);
    }
    centre(x, middle(x[EDML_R_HIP], x[EDML_L_HIP]));
}
