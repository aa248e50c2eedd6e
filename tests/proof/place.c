/* A placement of any accepted pose, keypoints and camera.
 *
 * SPDX-License-Identifier: MIT
 */
#include "sets.h"

#include "optional/camera/pnp.h"

static void with_set(uint16_t seen)
{
    static edml_pose pose;
    static edml_keypoint in[EDML_JOINTS];
    static edml_work work;
    edml_placement placement;
    edml_camera camera;
    const int32_t reach = (4 << 16) - 1;
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose.joint[j].x = Frama_C_interval(-reach, reach);
        pose.joint[j].y = Frama_C_interval(-reach, reach);
        pose.joint[j].z = Frama_C_interval(-reach, reach);
        in[j].x = some_pixels(is_seen(seen, j));
        in[j].y = some_pixels(is_seen(seen, j));
        in[j].c = some_confidence(is_seen(seen, j));
    }
    camera.fx = Frama_C_interval(1, ROOM);
    camera.fy = Frama_C_interval(1, ROOM);
    camera.cx = Frama_C_interval(-ROOM, ROOM);
    camera.cy = Frama_C_interval(-ROOM, ROOM);
    (void)edml_place(&placement, &pose, in, &camera, &work, sizeof work);
}

int main(void)
{
    for_sizes(with_set, MIN_JOINTS);
    return 0;
}
