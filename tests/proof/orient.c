/* Points of distances to the body's axes by the image alone, whatever joints were seen.
 *
 * SPDX-License-Identifier: MIT
 */
#include "sets.h"

#include "lift/orient.h"

static void with_set(uint16_t seen)
{
    static point x[EDML_JOINTS];
    static edml_image image;
    const real reach = REAL(5.71), far = REAL(3.9);
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j].x = Frama_C_interval(-reach, reach);
        x[j].y = Frama_C_interval(-reach, reach);
        x[j].z = Frama_C_interval(-reach, reach);
        image.at[j].u = Frama_C_interval(-far, far);
        image.at[j].v = Frama_C_interval(-far, far);
    }
    image.seen = seen;
    if (edml_orient(x, &image) != EDML_OK) return;
    for (int j = 0; j < EDML_JOINTS; j++) ASSERT(ALL_WITHIN(x[j], REAL(6.0)));
}

int main(void)
{
    for_sizes(with_set, 1);
    return 0;
}
