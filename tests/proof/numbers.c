/* What proof.h says of NORMALISE, for numbers of each length: they are below 1 then.  The largest comes first.
 *
 * SPDX-License-Identifier: MIT
 */
#include "proof.h"


static void normalised(int bits)
{
    real x[3];
    const int32_t high = (int32_t)((1U << bits) - 1), low = bits == 0 ? 0 : (int32_t)(1U << (bits - 1));
    x[0] = Frama_C_interval(0, 1) ? Frama_C_interval(low, high) : Frama_C_interval(-high, -low);
    x[1] = Frama_C_interval(-high, high);
    x[2] = Frama_C_interval(-high, high);
    const int exponent = normalise_q24(x, 3);
    ASSERT(exponent == (bits == 0 ? 0 : 24 - bits));
    for (int i = 0; i < 3; i++) ASSERT(-(1 << 24) <= x[i] && x[i] < 1 << 24);
}

int main(void)
{
    for (int bits = 0; bits <= 31; bits++) normalised(bits);
    return 0;
}
