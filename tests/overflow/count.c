/* Lifts every pose on standard input (14 edml_keypoint_q each, as they are in memory) in integers that
 * watch themselves, by edml_distances_w16 or, with the argument "direct", edml_direct_w16, and prints a line of
 * JSON: how many were lifted, the operations of a lift (mean and
 * largest), overflows, and lifts whose result was not that of the library.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "overflow.h"

enum { KINDS = 4 };

static void print_counts(const char *name, long sum, long largest, long lifted)
{
    printf(", \"%s\": [%ld, %ld]", name, lifted > 0 ? sum / lifted : 0, largest);
}

int main(int argc, char **argv)
{
    const edml_model *const model = argc > 1 && strcmp(argv[1], "direct") == 0 ? &edml_direct_w16
                                                                               : &edml_distances_w16;
    static const char *const names[KINDS] = {"sums", "products", "ratios", "roots"};
    edml_keypoint_q in[EDML_JOINTS];
    edml_work_q work;
    long sum[KINDS] = {0}, largest[KINDS] = {0}, lifted = 0, overflows = 0, differences = 0;
    while (fread(in, sizeof in, 1, stdin) == 1) {
        edml_pose_q pose, watched;
        checked_tally taken;
        memset(&pose, 0, sizeof pose);
        memset(&watched, 0, sizeof watched);
        const edml_status status = edml_lift_q(&pose, in, NULL, model, &work, sizeof work);
        if (checked_lift(&watched, in, NULL, model, &taken) != status ||
            memcmp(&pose, &watched, sizeof pose) != 0)
            differences++;
        overflows += taken.overflows;
        if (status != EDML_OK) continue;
        lifted++;
        const long of[KINDS] = {taken.sums, taken.products, taken.ratios, taken.roots};
        for (int k = 0; k < KINDS; k++) {
            sum[k] += of[k];
            if (of[k] > largest[k]) largest[k] = of[k];
        }
    }
    printf("{\"lifted\": %ld, \"overflows\": %ld, \"differences\": %ld", lifted, overflows, differences);
    for (int k = 0; k < KINDS; k++) print_counts(names[k], sum[k], largest[k], lifted);
    puts("}");
    return 0;
}
