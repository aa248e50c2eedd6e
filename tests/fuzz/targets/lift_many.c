/* edml_lift_many(): as many lifts, one by one.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS lift_many
#include "../native.h"

enum { MOST = 4 };

static edml_work work, other_work;

static edml_status lift_one(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_point *up,
                            const edml_camera *camera, const edml_model *model)
{
    if (camera == NULL) return edml_lift(pose, in, up, model, &other_work, sizeof other_work);
    return edml_lift_with_camera(pose, in, up, camera, model, &other_work, sizeof other_work);
}

void FUZZ_TARGET(lift_many)(choices *from)
{
    sighting frame[EDML_JOINTS];
    edml_keypoint in[MOST][EDML_JOINTS];
    edml_point ups[MOST];
    edml_pose poses[MOST], untouched, expected;
    edml_status statuses[MOST];
    place3 far, up;
    pinhole by;
    const int count = (int)draw_below(from, MOST + 2) - 1;
    const edml_model *model = draw_model(from);
    const int knows_up = draw_one_in(from, 2), knows_camera = draw_one_in(from, 4);
    draw_camera(&by, &far, from);
    const edml_camera camera = to_camera(by), *const used = knows_camera ? &camera : NULL;
    for (int n = 0; n < MOST; n++) {
        draw_frame(frame, from);
        to_keypoints(in[n], frame, EDML_JOINTS);
        draw_up(&up, from);
        ups[n] = to_point(up);
    }
    memset(poses, 0xA5, sizeof poses);
    memset(&untouched, 0xA5, sizeof untouched);
    for (int n = 0; n < MOST; n++) statuses[n] = EDML_ERR_TIME; /* which no lift returns */
    const int lifted = edml_lift_many(poses, statuses, in[0], knows_up ? ups : NULL, used, count, model,
                                      &work, sizeof work);
    int wanted = count < 0 ? -1 : 0;
    for (int n = 0; n < MOST; n++) {
        edml_status status = EDML_ERR_TIME;
        memset(&expected, 0xA5, sizeof expected);
        if (n < count) status = lift_one(&expected, in[n], knows_up ? &ups[n] : NULL, used, model);
        wanted += status == EDML_OK;
        REQUIRE(statuses[n] == status, "another status than a lift alone");
        REQUIRE(status != EDML_OK || are_same_poses(&poses[n], &expected),
                "another pose than a lift alone");
        REQUIRE(status == EDML_OK || memcmp(&poses[n], &untouched, sizeof untouched) == 0,
                "refused, but the pose was written");
    }
    REQUIRE(lifted == wanted, "another number of lifted ones");
}
