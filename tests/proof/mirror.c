/* The pose or its mirror image, of any points within 12 m on each axis.
 *
 * SPDX-License-Identifier: MIT
 */
#include "proof.h"

#include "lift/mirror.h"

int main(void)
{
    static point x[EDML_JOINTS];
    const real reach = REAL(12.0);
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j].x = Frama_C_interval(-reach, reach);
        x[j].y = Frama_C_interval(-reach, reach);
        x[j].z = Frama_C_interval(-reach, reach);
    }
    (void)edml_mirror(x, &edml_fconn_w16);
    return 0;
}
