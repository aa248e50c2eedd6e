/* edml_place() of any points before any camera.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS place
#include "../placement.h"

static edml_work work;

/* Moves keypoints and principal point alike by pixels, and scales all by a power of two, where nothing gets lost. */
static void check_scale_and_offset(const scene_before_camera *scene, choices *from)
{
    scene_before_camera given = *scene, other;
    edml_placement expected, found;
    pixels *number[2 * EDML_JOINTS + 4] = {&given.camera.fx, &given.camera.fy, &given.camera.cx,
                                           &given.camera.cy};
    for (int j = 0; j < EDML_JOINTS; j++) {
        number[2 * j + 4] = &given.in[j].x;
        number[2 * j + 5] = &given.in[j].y;
    }
    for (int n = 0; n < 2 * EDML_JOINTS + 4; n++) {
        const double wanted = nearbyint(16 * from_pixels(*number[n])) / 16;
        *number[n] = to_pixels(fabs(wanted) < 2048 ? wanted : 2048);
    }
    const edml_status status = edml_place(&expected, &given.pose, given.in, &given.camera, &work,
                                          sizeof work);
    const pixels x = to_pixels(draw_below(from, 256)), y = to_pixels(draw_below(from, 256));
    const double scale = ldexp(1, (int)draw_below(from, IS_EXACT ? 200 : 4) - (IS_EXACT ? 100 : 3));
    other = given;
    for (int j = 0; j < EDML_JOINTS; j++) {
        other.in[j].x = to_pixels(scale * from_pixels(given.in[j].x + x));
        other.in[j].y = to_pixels(scale * from_pixels(given.in[j].y + y));
    }
    other.camera.cx = to_pixels(scale * from_pixels(given.camera.cx + x));
    other.camera.cy = to_pixels(scale * from_pixels(given.camera.cy + y));
    other.camera.fx = to_pixels(scale * from_pixels(given.camera.fx));
    other.camera.fy = to_pixels(scale * from_pixels(given.camera.fy));
    REQUIRE(edml_place(&found, &other.pose, other.in, &other.camera, &work, sizeof work) == status,
            "another status elsewhere, or of another scale");
    if (status != EDML_OK) return;
    REQUIRE(are_same_placements(&expected, &found), "another placement elsewhere, or of another scale");
    const double off = from_pixels(found.reprojection) - scale * from_pixels(expected.reprojection);
    REQUIRE(fabs(off) <= (IS_EXACT ? 0 : 3.0 / 65536), "another reprojection error elsewhere");
}

/* Confidences are shares of their sum, and joints without one do not count. */
static void check_confidences(const scene_before_camera *scene, const edml_placement *expected,
                              choices *from)
{
    scene_before_camera other = *scene;
    edml_placement found;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (other.in[j].c > 0) {
            if (IS_EXACT) other.in[j].c /= 2;
            continue;
        }
        other.in[j].x = to_pixels(draw_extreme(from));
        other.in[j].y = to_pixels(draw_extreme(from));
    }
    REQUIRE(edml_place(&found, &other.pose, other.in, &other.camera, &work, sizeof work) == EDML_OK,
            "refused for its confidences");
    REQUIRE(are_same_placements(expected, &found), "what was not seen changes a placement");
}

void FUZZ_TARGET(place)(choices *from)
{
    scene_before_camera scene;
    edml_placement placement, watched;
    snapshot before;
    const uint32_t further = draw_bits(from, 1);
    draw_scene(&scene, from);
    memset(&placement, 0xA5, sizeof placement);
    memset(&watched, 0xA5, sizeof watched);
    memset(&work, (int)further, sizeof work);
    take_snapshot(&before, &placement, sizeof placement);
    const edml_status status = edml_place(&placement, &scene.pose, scene.in, &scene.camera, &work,
                                          sizeof work);
    (void)watched;
    WATCH(status, checked_place(&watched, &scene.pose, scene.in, &scene.camera, &taken), &placement,
          &watched, offsetof(edml_placement, steps));
    if (further % 8 == 0) check_scale_and_offset(&scene, from);
    if (!check_status(status, PLACE_CAUSES, &before)) return;
    check_placement(&placement, &scene);
    if (further % 8 == 1) check_confidences(&scene, &placement, from);
}
