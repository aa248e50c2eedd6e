/* From the axes of the MDS to those of the network's points.
 *
 * SPDX-License-Identifier: MIT
 */
#include "proof.h"

#include "lift/align.h"

int main(void)
{
    static point x[EDML_JOINTS], onto[EDML_JOINTS];
    const real reach = REAL(5.71), far = REAL(6.0);
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j].x = Frama_C_interval(-reach, reach);
        x[j].y = Frama_C_interval(-reach, reach);
        x[j].z = Frama_C_interval(-reach, reach);
        onto[j].x = Frama_C_interval(-far, far);
        onto[j].y = Frama_C_interval(-far, far);
        onto[j].z = Frama_C_interval(-far, far);
    }
    edml_align(x, onto, &edml_distances_w16);
    return 0;
}
