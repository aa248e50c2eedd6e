/* What the fuzzers of the library share: choices out of bytes, demands, and the table of targets.
 *
 * A target is a function of bytes that calls public functions of the library and demands what their headers
 * promise.  It draws choices from the bytes, so that any bytes are an input, and most are people.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FUZZ_H
#define EDML_FUZZ_H

#include <stddef.h>
#include <stdint.h>

/* ---- Choices ------------------------------------------------------------------------------------ */

/* Bytes that are still to be drawn.  Behind their end come pseudo-random ones, the same for all inputs. */
typedef struct {
    const uint8_t *at, *end;
    uint32_t behind;
} choices;

uint32_t draw_bits(choices *from, int bytes);       /* 1 to 4 */
uint32_t draw_below(choices *from, uint32_t limit); /* 0 to limit - 1 */
int draw_one_in(choices *from, uint32_t count);
double draw_between(choices *from, double least, double most);   /* evenly */
double draw_magnitude(choices *from, double least, double most); /* so are the logarithms; least > 0 */

/* ---- Demands ------------------------------------------------------------------------------------ */

/* Ends the program, naming target and demand, if it does not hold. */
#define REQUIRE(holds, what) ((holds) ? (void)0 : fuzz_fail(what))
void fuzz_fail(const char *what);

/* A copy of what a call may write, to be compared if it fails. */
typedef struct {
    const void *memory;
    size_t size;
    uint8_t copy[1536];
} snapshot;

void take_snapshot(snapshot *of, const void *memory, size_t size);

/* Demands that a status is one of `allowed`, a sum of ALLOW(), besides EDML_OK, and that a call with any other
 * one has written nothing.  Returns whether it is EDML_OK. */
#define ALLOW(status) (1U << -(status))
int check_status(int status, unsigned allowed, const snapshot *of);

/* ---- Targets ------------------------------------------------------------------------------------ */

/* Is this an input that numbers which watch themselves (tests/overflow) compute as well?  They take ten times as
 * long. */
extern int fuzz_watches;

typedef void fuzz_target(choices *from);

/* Each is a file of targets/.  Those of both arithmetics are compiled twice, and have two names. */
#define FUZZ_TARGETS_OF_BOTH(X)                                                                            \
    X(adapt)                                                                                               \
    X(lift)                                                                                                \
    X(fconv)                                                                                               \
    X(lift_with_camera)                                                                                    \
    X(lift_many)                                                                                           \
    X(place)                                                                                               \
    X(place_sweep)                                                                                         \
    X(path)                                                                                                \
    X(focal)                                                                                               \
    X(track)                                                                                               \
    X(body)                                                                                                \
    X(quality)                                                                                             \
    X(joint_limits)                                                                                        \
    X(stand)                                                                                               \
    X(angles)                                                                                              \
    X(body_frame)                                                                                          \
    X(predict)                                                                                             \
    X(eigen)                                                                                               \
    X(mds)                                                                                                 \
    X(orient)
#define FUZZ_TARGETS_OF_ONE(X)                                                                             \
    X(names)                                                                                               \
    X(agree)

#endif
