/* The network's part of the lift by MODEL: from any image in the body's frame to what it gives.
 *
 * SPDX-License-Identifier: MIT
 */
#include "proof.h"

#include "lift/predict.h"

int main(void)
{
    static edml_work work;
    point up;
    const real reach = REAL(3.9), one = REAL(1.0) + 1, far = REAL(3.0);
    for (int j = 0; j < EDML_JOINTS; j++) {
        work.image.at[j].u = Frama_C_interval(-reach, reach);
        work.image.at[j].v = Frama_C_interval(-reach, reach);
    }
    work.image.down.u = Frama_C_interval(-one, one);
    work.image.down.v = Frama_C_interval(-one, one);
    work.image.seen = (uint16_t)Frama_C_interval(0, ALL_JOINTS);
    up.x = Frama_C_interval(-one, one);
    up.y = Frama_C_interval(-one, one);
    up.z = Frama_C_interval(-one, one);
    predict(&work.of.points.prediction, &work.image, Frama_C_interval(0, 1) ? &up : NULL, &MODEL, &work);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const point p = work.of.points.prediction.x[j];
        ASSERT(WITHIN(p.x, 2 * far) && WITHIN(p.y, 2 * far) && WITHIN(p.z, 2 * far));
        ASSERT(0 <= work.of.points.prediction.share[j] && work.of.points.prediction.share[j] <= one);
    }
    for (int k = 0; k < EDML_PAIRS && MODEL.gives & EDML_GIVES_DISTANCES; k++) {
        const real d = work.of.points.prediction.distance[k];
        ASSERT(0 <= d && d <= far);
    }
    return 0;
}
