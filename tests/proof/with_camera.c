/* A lift with a camera, but for the lift: any accepted keypoints, camera, upward direction and pose.
 *
 * SPDX-License-Identifier: MIT
 */
#include "sets.h"

#include "network/model.h"

static edml_status some_pose(edml_pose *pose);

#define edml_lift_q(pose, in, up, model, work, work_bytes) ((void)(turned_up), some_pose(pose))
#include "optional/camera/lift_with_camera.h"
#undef edml_lift_q

/* What edml_lift_q() may give. */
static edml_status some_pose(edml_pose *pose)
{
    const int32_t reach = 45 << 16, away = 12 << 16;
    for (int j = 0; j < EDML_JOINTS; j++) {
        pose->joint[j].x = Frama_C_interval(-reach, reach);
        pose->joint[j].y = Frama_C_interval(-reach, reach);
        pose->joint[j].z = Frama_C_interval(-away, away);
    }
    return EDML_OK;
}

static void with_set(uint16_t seen)
{
    static edml_pose pose;
    static edml_keypoint in[EDML_JOINTS];
    static edml_work work;
    static edml_model model;
    const edml_camera camera = {Frama_C_interval(1, ROOM), Frama_C_interval(1, ROOM),
                                Frama_C_interval(-ROOM, ROOM), Frama_C_interval(-ROOM, ROOM)};
    const edml_point up = {Frama_C_interval(-ROOM, ROOM), Frama_C_interval(-ROOM, ROOM),
                           Frama_C_interval(-ROOM, ROOM)};
    for (int j = 0; j < EDML_JOINTS; j++) {
        in[j].x = some_pixels(is_seen(seen, j));
        in[j].y = some_pixels(is_seen(seen, j));
        in[j].c = some_confidence(is_seen(seen, j));
    }
    (void)edml_lift_with_camera(&pose, in, Frama_C_interval(0, 1) ? &up : NULL, &camera, &model, &work,
                                sizeof work);
}

int main(void)
{
    for_sizes(with_set, 1);
    return 0;
}
