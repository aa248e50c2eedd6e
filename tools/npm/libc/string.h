/* What the library takes from the C library's string.h, by the compiler itself: WebAssembly has instructions for it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef STRING_H
#define STRING_H

#define memcpy __builtin_memcpy
#define memset __builtin_memset

#endif
