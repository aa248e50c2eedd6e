/* Distances to points.
 *
 * SPDX-License-Identifier: MIT
 */
#include "proof.h"

#include "lift/mds.h"

int main(void)
{
    static edml_work work;
    static point x[EDML_JOINTS];
    static real distance[EDML_PAIRS];
    for (int k = 0; k < EDML_PAIRS; k++) distance[k] = Frama_C_interval(0, REAL(3.0));
    edml_mds(x, distance, &work);
    for (int j = 0; j < EDML_JOINTS; j++) ASSERT(ALL_WITHIN(x[j], REAL(5.71)));
    return 0;
}
