/* edml_place_sweep(): the best of the placements with twelve focal lengths.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS place_sweep
#include "../placement.h"

static edml_work work;

/* No focal length gives a smaller error; one of them gives this placement. */
static void check_choice(const edml_placement *best, scene_before_camera *scene, pixels height)
{
    const pixels chosen = scene->camera.fx;
    int is_one = 0;
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++) {
        edml_placement tried;
        const real factor = to_real(nearbyint(0.5e6 * pow(8, n / 11.0)) / 1e6);
        scene->camera.fx = scene->camera.fy = 8 * MUL(height, factor / 8);
        is_one |= scene->camera.fx == chosen;
        if (edml_place(&tried, &scene->pose, scene->in, &scene->camera, &work, sizeof work) == EDML_OK)
            REQUIRE(tried.reprojection >= best->reprojection, "another focal length is better");
    }
    REQUIRE(is_one, "a focal length that is none of the twelve");
}

void FUZZ_TARGET(place_sweep)(choices *from)
{
    static const double factors[] = {0, -1, NAN, INFINITY, 1e-30, 1e30, 8, 0.01};
    scene_before_camera scene;
    struct {
        edml_placement placement;
        edml_camera camera;
    } out, again;
    snapshot before;
    const uint32_t further = draw_below(from, 32);
    draw_scene(&scene, from);
    double width = 2 * from_pixels(scene.camera.cx), height = 2 * from_pixels(scene.camera.cy);
    if (further < 8) height *= factors[further];
    if (further == 8) width = draw_extreme(from);
    memset(&out, 0xA5, sizeof out);
    again = out;
    (void)again;
    take_snapshot(&before, &out, sizeof out);
    const edml_status status = edml_place_sweep(&out.placement, &out.camera, &scene.pose, scene.in,
                                                to_pixels(width), to_pixels(height), &work, sizeof work);
    WATCH(status,
          checked_place_sweep(&again.placement, &again.camera, &scene.pose, scene.in, to_pixels(width),
                              to_pixels(height), &taken),
          &out, &again, offsetof(edml_placement, steps));
    if (!check_status(status, PLACE_CAUSES, &before)) return;
    REQUIRE(out.camera.cx == to_pixels(width) / 2 && out.camera.cy == to_pixels(height) / 2,
            "the principal point is not the middle");
    scene.camera = out.camera;
    check_placement(&out.placement, &scene);
    edml_placement alone = out.placement;
    REQUIRE(edml_place(&alone, &scene.pose, scene.in, &scene.camera, &work, sizeof work) == EDML_OK &&
                memcmp(&alone, &out.placement, offsetof(edml_placement, steps)) == 0,
            "not the placement of its camera");
    REQUIRE(out.camera.fx == out.camera.fy, "two focal lengths");
    if (further >= 28) check_choice(&out.placement, &scene, to_pixels(height));
}
