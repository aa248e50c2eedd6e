/* Points moved downhill, of any within 63 m along each axis and any distances, by each objective.
 *
 * A step is taken from points that are less than 8 m apart, and computes with their differences alone: so
 * those around the origin stand for all.
 *
 * SPDX-License-Identifier: MIT
 */
#include "proof.h"

#include "lift/refine.h"

enum { STEPS = 14, METRE = 1 << 24 };

static edml_work work;
static point x[EDML_JOINTS];
static real distance[EDML_PAIRS];

static void refine_points(int metres, int steps)
{
    const edml_objective objective = (edml_objective)Frama_C_interval(EDML_STRESS_NONE, EDML_STRESS_EQ2);
    const real reach = metres * METRE;
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j].x = Frama_C_interval(-reach, reach);
        x[j].y = Frama_C_interval(-reach, reach);
        x[j].z = Frama_C_interval(-reach, reach);
    }
    (void)edml_stress(x, distance, objective);
    (void)edml_refine(x, distance, objective, Frama_C_interval(0, steps), &work);
}

int main(void)
{
    for (int k = 0; k < EDML_PAIRS; k++) distance[k] = Frama_C_interval(0, REAL(3.0));
    refine_points(63, 0);
    refine_points(4, STEPS);
    for (int j = 0; j < EDML_JOINTS; j++) ASSERT(ALL_WITHIN(x[j], (4 + 4 * STEPS) * METRE));
    return 0;
}
