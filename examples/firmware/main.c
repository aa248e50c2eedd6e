/* Lifts a recorded walk on bare metal and prints a line a pose, in integers: its index, status, misfit and x,
 * y, z of the 14 joints, in millimetres.  The last line is a checksum of every bit of the results, the same on
 * every core.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>
#include <string.h>

#include "arithmetic.h"

/* Stands where a detector would be: x, y in hundredths of a pixel, and c of each joint. */
static const int32_t walk[][3 * EDML_JOINTS] = {
#include "walk.inc"
};
enum { POSES = (int)(sizeof walk / sizeof walk[0]) };

static work_memory work; /* 1.9 KB: static, because it is large for a stack */

static void detect(keypoint in[EDML_JOINTS], const int32_t row[3 * EDML_JOINTS])
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = pixels(row[3 * j]);
        in[j].y = pixels(row[3 * j + 1]);
        in[j].c = confidence(row[3 * j + 2]);
    }
}

static void print(int index, edml_status status, const pose *lifted)
{
    printf("%d,%s", index, edml_status_name(status));
    if (status == EDML_OK) {
        printf(",%d", thousandths(lifted->misfit));
        for (int j = 0; j < EDML_JOINTS; j++)
            printf(",%d,%d,%d", thousandths(lifted->joint[j].x), thousandths(lifted->joint[j].y),
                   thousandths(lifted->joint[j].z));
    }
    printf("\n");
}

/* FNV-1a over numbers of 32 bits, from the lowest byte up. */
static uint32_t add_bits(uint32_t hash, const void *numbers, size_t size)
{
    for (size_t at = 0; at < size; at += sizeof(uint32_t)) {
        uint32_t bits;
        memcpy(&bits, (const char *)numbers + at, sizeof bits);
        for (int n = 0; n < 4; n++) hash = (hash ^ (bits >> 8 * n & 0xFF)) * 16777619U;
    }
    return hash;
}

int main(void)
{
    uint32_t hash = 2166136261U;
    int refused = edml_model_check(&MODEL) != EDML_OK;
    printf("%s %s\n", edml_model_name(&MODEL), refused ? "is damaged" : "is intact");
    for (int i = 0; i < POSES; i++) {
        keypoint in[EDML_JOINTS];
        pose lifted;
        detect(in, walk[i]);
        const edml_status status = LIFT(&lifted, in, NULL, &MODEL, &work, sizeof work);
        print(i, status, &lifted);
        if (status == EDML_OK) {
            hash = add_bits(hash, lifted.joint, sizeof lifted.joint);
            hash = add_bits(hash, &lifted.misfit, sizeof lifted.misfit);
        }
        refused += status != EDML_OK;
    }
    printf("checksum %08lx, %d refused\n", (unsigned long)hash, refused);
    return refused > 0;
}
