/* rows.h for blocks by pair, in the words of a Cortex-M with the DSP extension, which multiplies two pairs of 16
 * bits at a time: eight rows, of the pairs of inputs that are not both zero, which are listed once a layer.  Weights
 * of 8 bits are widened two at a time: the first and the third byte of a word are of one row, the second and the
 * fourth of the next.
 *
 * A part's list has, for each of its pairs, how many bytes of weights are left out before it, and the pair.  Its end is
 * what is left out behind the last pair, and zero.  The list of the odd part follows that of the even one.
 *
 *   out x out x ... out 0     out x out x ... out 0
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_ROWS_DSP_H
#define EDML_ROWS_DSP_H

#include "layer_inputs.h"

enum {
    ROWS = EDML_ROWS,
    LISTED = 4 * EDML_MAX_VALUES, /* bytes */
    LIST_IN_PLACE = 1
};

typedef char lists_hold_all_pairs_and_the_ends_of_two_parts[LISTED >= 4 * (EDML_MAX_UNITS + 4) ? 1 : -1];

/* clang-format off */
#ifdef EDML_BYTES
#define BYTES_OF_PAIR "16"
#define ADD_TWO_ROWS(w, sum, next)              \
    "    sxtb16 lr, " w "\n"                    \
    "    smlad  " sum ", lr, r0, " sum "\n"     \
    "    sxtb16 " w ", " w ", ror #8\n"         \
    "    smlad  " next ", " w ", r0, " next "\n"
#define ADD_ROWS                                                                \
    "    ldrd   r3, r12, [r2], #8\n"                                            \
    ADD_TWO_ROWS("r3", "r4", "r5") ADD_TWO_ROWS("r12", "r6", "r7")              \
    "    ldrd   r3, r12, [r2], #8\n"                                            \
    ADD_TWO_ROWS("r3", "r8", "r9") ADD_TWO_ROWS("r12", "r10", "r11")
#else
#define BYTES_OF_PAIR "32"
#define ADD_THREE_ROWS(first, second, third)            \
    "    ldmia  r2!, {r3, r12, lr}\n"                   \
    "    smlad  " first ", r3, r0, " first "\n"         \
    "    smlad  " second ", r12, r0, " second "\n"      \
    "    smlad  " third ", lr, r0, " third "\n"
#define ADD_ROWS                                                                \
    ADD_THREE_ROWS("r4", "r5", "r6") ADD_THREE_ROWS("r7", "r8", "r9")           \
    "    ldrd   r3, r12, [r2], #8\n"                                            \
    "    smlad  r10, r3, r0, r10\n"                                             \
    "    smlad  r11, r12, r0, r11\n"
#endif

#define ADD_PAIR                                \
    "    ldrd   r3, r0, [r1], #8\n"             \
    "    add    r2, r3\n"                       \
    "    cbz    r0, 2f\n"                       \
    ADD_ROWS
#ifdef EDML_BYTES
#define ADD_PAIRS ADD_PAIR /* as many as a cbz jumps over */
#else
#define ADD_PAIRS ADD_PAIR ADD_PAIR
#endif

/*   r0 a pair of x     r1 list, r2 w     r3 what is left out; r3, r12, lr weights     r4 to r11 the sums */
__attribute__((naked, noinline)) static void sum_eight(
    value sum[2][ROWS] EDML_IN_REGISTER, const uint8_t *list EDML_IN_REGISTER,
    const weight *w EDML_IN_REGISTER, const value *bias EDML_IN_REGISTER)
{
    __asm__("    push   {r0, r4-r11, lr}\n"
            "    ldmia  r3, {r4-r11}\n"
            "    push   {r1}\n" /* [sp] not zero in the first part, [sp, #4] where sums go */
            "1:\n"
            ADD_PAIRS
            "    b      1b\n"
            "2:  ldrd   r3, r12, [sp]\n"
            "    stmia  r12!, {r4-r11}\n"
            "    cbz    r3, 3f\n"
            "    strd   r0, r12, [sp]\n"
            "    mov    r4, r0\n"
            "    mov    r5, r0\n"
            "    mov    r6, r0\n"
            "    mov    r7, r0\n"
            "    mov    r8, r0\n"
            "    mov    r9, r0\n"
            "    mov    r10, r0\n"
            "    mov    r11, r0\n"
            "    b      1b\n"
            "3:  add    sp, #8\n"
            "    pop    {r4-r11, pc}\n");
}

static inline void sum_rows(value sum[2][ROWS], const layer_inputs *in, const weight *w, const value *bias,
                            int rows)
{
    (void)rows;
    sum_eight(sum, in->list, w, bias);
}

#define LIST_PAIR                               \
    "    ldr    r4, [r1, #-4]!\n"               \
    "    cbz    r4, 9f\n"                       \
    "    strd   r4, r3, [r0, #-8]!\n"           \
    "    mvn    r3, #" BYTES_OF_PAIR "-1\n"     \
    "9:  adds   r3, #" BYTES_OF_PAIR "\n"

/* Lists the pairs from x to `end`, a multiple of CHUNK, the last one first, downwards from list_end.  The list may
 * overwrite pairs that have been read.  Returns its first word.
 *
 *   r0 list     r1, r2 from the end to the start of x     r3 bytes left out     r4 a pair of x */
__attribute__((naked, noinline)) static uint32_t *list_part(
    uint32_t *list_end EDML_IN_REGISTER, const activation *end EDML_IN_REGISTER,
    const activation *x EDML_IN_REGISTER)
{
    __asm__("    push   {r4, lr}\n"
            "    movs   r3, #0\n"
            "    str    r3, [r0, #-4]!\n"
            "    cmp    r1, r2\n"
            "    beq    2f\n"
            "1:\n"
            LIST_PAIR LIST_PAIR LIST_PAIR LIST_PAIR /* a chunk */
            "    cmp    r1, r2\n"
            "    bne    1b\n"
            "2:  str    r3, [r0, #-4]!\n"
            "    pop    {r4, pc}\n");
}
/* clang-format on */

/* list: [LISTED], aligned as a word; it may begin where x does. */
static inline void list_inputs(layer_inputs *in, activation *x, uint8_t *list)
{
    uint32_t *const end = (uint32_t *)(void *)list + LISTED / 4;
    uint32_t *const odd = list_part(end, x + in->inputs, x + in->even);
    in->list = (const uint8_t *)list_part(odd, x + in->even, x);
}

#endif
