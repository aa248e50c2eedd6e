/* What the compiler is told beyond C99.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_COMPILER_H
#define EDML_COMPILER_H

#include <stdint.h>

/* EDML_NOINLINE     keep out of line, so that its locals leave the stack before the caller calls deeper
 * EDML_INLINE       inline also where the compiler is told to save space
 * EDML_RESTRICT     C99's restrict, which C++ has under another name
 * EDML_ALIGN4       weights that may be loaded a word at a time
 * EDML_IS_ALIGNED4  may words be at this pointer?
 * EDML_IN_REGISTER  an argument of a function in assembly
 * EDML_DIVIDES      the processor has an instruction for a division; else a table and products are faster
 * EDML_COUNT_ZEROS  before the highest bit of a word, where the processor has an instruction for it
 * EDML_HIGH_PRODUCT high = (a b + 2^31) >> 32, the same
 * EDML_SATURATE     y = x limited to 0 to 2^bits - 1, the same
 * EDML_HALVE_TO_16_BITS  y = x >> 1 limited to 16 bits, the same
 * EDML_WEAK         a function that is NULL unless something else links it
 * EDML_INTERNAL     shared by the library's files, and not exported from a shared library */
#ifdef __GNUC__
#define EDML_NOINLINE __attribute__((noinline))
#define EDML_INLINE inline __attribute__((always_inline))
#define EDML_RESTRICT __restrict
#define EDML_ALIGN4 __attribute__((aligned(4)))
#define EDML_IN_REGISTER __attribute__((unused)) /* which the compiler does not see */
#else
#define EDML_NOINLINE
#define EDML_INLINE inline
#define EDML_RESTRICT
#define EDML_ALIGN4
#endif
#ifndef __ARM_ARCH_6M__
#define EDML_DIVIDES
#endif
#if defined(__ARM_FEATURE_CLZ) || defined(__x86_64__) || defined(__aarch64__) || defined(__riscv_zbb)
#define EDML_COUNT_ZEROS(n) __builtin_clz(n)
#endif
#if defined(__ARM_FEATURE_DSP) && defined(__thumb2__) && defined(__GNUC__)
#define EDML_HIGH_PRODUCT(high, a, b) __asm__("smmulr %0, %1, %2" : "=r"(high) : "r"(a), "r"(b))
#endif
#if defined(__ARM_FEATURE_SAT) && defined(__thumb2__) && defined(__OPTIMIZE__) /* else bits are no constant */
#define EDML_SATURATE(y, bits, x) __asm__("usat %0, %1, %2" : "=r"(y) : "I"(bits), "r"(x) : "cc")
#define EDML_HALVE_TO_16_BITS(y, x) __asm__("ssat %0, #16, %1, asr #1" : "=r"(y) : "r"(x) : "cc")
#endif
#define EDML_IS_ALIGNED4(pointer) (((uintptr_t)(pointer) & 3) == 0)
#if defined(__GNUC__) && (defined(__ELF__) || defined(__clang__))
#define EDML_INTERNAL __attribute__((visibility("hidden")))
#else
#define EDML_INTERNAL
#endif
#if defined(__GNUC__) && (defined(__ELF__) || defined(__wasm__))
#define EDML_WEAK __attribute__((weak))
#else
#define EDML_WEAK
#endif

#endif
