/* Imputation by the default weights, for each set of seen joints, anywhere in their box.
 *
 * SPDX-License-Identifier: MIT
 */
#include "sets.h"

#include "lift/impute.h"

static void with_set(uint16_t seen)
{
    static edml_image_point at[EDML_JOINTS];
    static real scratch[MAX_IMPUTED * MAX_IMPUTED];
    const real box = REAL(1.0005) + 1, most = REAL(32.0);
    for (int j = 0; j < EDML_JOINTS; j++) {
        at[j].u = is_seen(seen, j) ? Frama_C_interval(-box, box) : 0;
        at[j].v = is_seen(seen, j) ? Frama_C_interval(-box, box) : 0;
    }
    ASSERT(impute(at, seen, &edml_default_imputation, scratch));
    for (int j = 0; j < EDML_JOINTS; j++) ASSERT(WITHIN(at[j].u, most) && WITHIN(at[j].v, most));
}

int main(void)
{
    for_sets(with_set);
    return 0;
}
