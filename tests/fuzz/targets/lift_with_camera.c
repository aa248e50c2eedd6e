/* edml_lift_with_camera() of any frame of any camera.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS lift_with_camera
#include "../native.h"

static edml_work work;

enum {
    CAUSES = ALLOW(EDML_ERR_NOT_FINITE) | ALLOW(EDML_ERR_TOO_FEW_JOINTS) | ALLOW(EDML_ERR_DEGENERATE) |
             ALLOW(EDML_ERR_CAMERA)
};

/* Only where keypoints are from the principal point counts, and in units of the focal lengths. */
static void check_scale_and_offset(const sighting frame[EDML_JOINTS], pinhole by, const edml_point *up,
                                   const edml_model *model, choices *from)
{
    sighting given[EDML_JOINTS];
    edml_keypoint in[EDML_JOINTS];
    edml_pose expected, found;
    memcpy(given, frame, sizeof given);
    round_sightings(given);
    by.fx = nearbyint(by.fx);
    by.fy = nearbyint(by.fy);
    by.cx = nearbyint(by.cx);
    by.cy = nearbyint(by.cy);
    if (!(fabs(by.fx) + fabs(by.fy) + fabs(by.cx) + fabs(by.cy) < 8000)) return;
    to_keypoints(in, given, EDML_JOINTS);
    edml_camera camera = to_camera(by);
    const edml_status status = edml_lift_with_camera(&expected, in, up, &camera, model, &work, sizeof work);
    const double x = (double)draw_below(from, 256) - 128, y = (double)draw_below(from, 256) - 128;
    const double scale = ldexp(1, (int)draw_below(from, IS_EXACT ? 200 : 4) - (IS_EXACT ? 100 : 3));
    for (int j = 0; j < EDML_JOINTS; j++) {
        given[j].x = scale * (given[j].x + x);
        given[j].y = scale * (given[j].y + y);
    }
    const pinhole other = {scale * by.fx, scale * by.fy, scale * (by.cx + x), scale * (by.cy + y)};
    to_keypoints(in, given, EDML_JOINTS);
    camera = to_camera(other);
    REQUIRE(edml_lift_with_camera(&found, in, up, &camera, model, &work, sizeof work) == status,
            "another status elsewhere, or of another scale");
    REQUIRE(status != EDML_OK || are_same_poses(&expected, &found),
            "another pose elsewhere, or of another scale");
}

void FUZZ_TARGET(lift_with_camera)(choices *from)
{
    place3 x[EDML_JOINTS], far, upwards;
    sighting frame[EDML_JOINTS];
    edml_keypoint in[EDML_JOINTS];
    edml_pose pose, watched;
    snapshot before;
    pinhole by;
    const uint32_t further = draw_bits(from, 1);
    const edml_model *model = draw_model(from);
    const int knows_up = draw_up(&upwards, from);
    const edml_point up = to_point(upwards), *const above = knows_up ? &up : NULL;
    draw_points(x, from);
    draw_camera(&by, &far, from);
    draw_sightings(frame, x, &by, far, from);
    if (draw_one_in(from, 8)) draw_camera(&by, &far, from); /* another one */
    to_keypoints(in, frame, EDML_JOINTS);
    const edml_camera camera = to_camera(by);
    memset(&pose, 0xA5, sizeof pose);
    memset(&watched, 0xA5, sizeof watched);
    memset(&work, (int)further, sizeof work);
    take_snapshot(&before, &pose, sizeof pose);
    const edml_status status = edml_lift_with_camera(&pose, in, above, &camera, model, &work, sizeof work);
    (void)watched;
    WATCH(status, checked_lift_with_camera(&watched, in, above, &camera, model, &taken), &pose, &watched,
          offsetof(edml_pose, seen));
    if (further % 8 == 0) check_scale_and_offset(frame, by, above, model, from);
    if (!check_status(status, CAUSES, &before)) return;
    check_pose(&pose);
    REQUIRE(pose.seen == seen_of(in), "another seen mask");
}
