/* The whole of edml_lift_q() by edml_direct_w16, for a set of seen joints of each size.
 *
 * SPDX-License-Identifier: MIT
 */
#include "sets.h"

#include "lift/lift.h"

static void with_set(uint16_t seen)
{
    static edml_pose pose;
    static edml_keypoint in[EDML_JOINTS];
    static edml_work work;
    const edml_point up = {Frama_C_interval(-ROOM, ROOM), Frama_C_interval(-ROOM, ROOM),
                           Frama_C_interval(-ROOM, ROOM)};
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = some_pixels(is_seen(seen, j));
        in[j].y = some_pixels(is_seen(seen, j));
        in[j].c = some_confidence(is_seen(seen, j));
    }
    (void)edml_lift(&pose, in, Frama_C_interval(0, 1) ? &up : NULL, &edml_direct_w16, &work, sizeof work);
}

int main(void)
{
    for_sizes(with_set, FEWEST);
    return 0;
}
