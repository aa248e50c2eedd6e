/* The last stage of the lift: from points to the camera's axes, with what any model says of the fusion.
 *
 * SPDX-License-Identifier: MIT
 */
#include "sets.h"

#include "lift/lift.h"

static void with_set(uint16_t seen)
{
    static point x[EDML_JOINTS];
    static edml_image image;
    static real share[EDML_JOINTS];
    static edml_model model;
    const real reach = REAL(3.9), one = REAL(1.0) + 1, far = REAL(6.0);
    for (int j = 0; j < EDML_JOINTS; j++) {
        image.at[j].u = Frama_C_interval(-reach, reach);
        image.at[j].v = Frama_C_interval(-reach, reach);
        x[j].x = Frama_C_interval(-far, far);
        x[j].y = Frama_C_interval(-far, far);
        x[j].z = Frama_C_interval(-far, far);
        share[j] = Frama_C_interval(0, one);
    }
    image.down.u = Frama_C_interval(-one, one);
    image.down.v = Frama_C_interval(-one, one);
    image.seen = seen;
    model.fusion[FUSION_SQUARE].q24 = Frama_C_interval(REAL(0.0001), one);
    model.fusion[FUSION_NEARNESS].q24 = Frama_C_interval(0, REAL(0.33333334));
    const real misfit = edml_fuse(x, &image, share, &model);
    ASSERT(0 <= misfit && misfit <= REAL(13.0));
    turn_to_camera(x, image.down);
    for (int j = 0; j < EDML_JOINTS; j++) {
        ASSERT(WITHIN(x[j].x, REAL(84.0)) && WITHIN(x[j].y, REAL(84.0)) && WITHIN(x[j].z, REAL(12.0)));
        (void)api_point(x[j]);
    }
}

int main(void)
{
    for_sizes(with_set, FEWEST);
    return 0;
}
