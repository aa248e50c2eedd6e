/* What the library takes from the C library's math.h, by the compiler itself: WebAssembly has instructions for it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef MATH_H
#define MATH_H

#define sqrtf __builtin_sqrtf
#define fabsf __builtin_fabsf
#define isfinite __builtin_isfinite
#define isnan __builtin_isnan
#define HUGE_VALF __builtin_huge_valf()
#define NAN __builtin_nanf("")

#endif
