/* What lift/inputs.h assumes of soften(), for every distance in pieces of a 64th.
 *
 * SPDX-License-Identifier: MIT
 */
#include "proof.h"

#undef ASSUME
#define ASSUME(condition) ASSERT(condition)

#include "lift/inputs.h"

int main(void)
{
    const real piece = REAL(0.015625);
    /*@ loop unroll 1024; */
    for (real d = 0; d < REAL(12.0); d += piece) (void)soften(Frama_C_interval(d, d + piece));
    return 0;
}
