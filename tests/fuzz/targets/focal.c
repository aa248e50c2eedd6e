/* edml_focal_start(), _add() and _camera(): the search for a focal length.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS focal
#include "../placement.h"

static edml_work work;

typedef struct {
    edml_focal focal;
    edml_camera camera;
} search;

static edml_status start(search *s, double width, double height)
{
    snapshot before;
    take_snapshot(&before, s, sizeof *s);
    const edml_status status = edml_focal_start(&s->focal, to_pixels(width), to_pixels(height));
    if (check_status(status, ALLOW(EDML_ERR_CAMERA), &before)) {
        REQUIRE(s->focal.poses == 0, "a search that begins with poses");
        take_snapshot(&before, s, sizeof *s);
        REQUIRE(edml_focal_camera(&s->camera, &s->focal) == EDML_ERR_CAMERA, "a camera of nothing");
        check_status(EDML_ERR_CAMERA, ALLOW(EDML_ERR_CAMERA), &before);
    }
    return status;
}

/* A camera about the middle, of a focal length that the sweep has. */
static void check_camera(search *s)
{
    snapshot before;
    take_snapshot(&before, s, sizeof *s);
    const edml_status status = edml_focal_camera(&s->camera, &s->focal);
    if (!check_status(status, ALLOW(EDML_ERR_CAMERA), &before)) return;
    const double focal = from_pixels(s->camera.fx), height = from_pixels(s->focal.height);
    REQUIRE(s->camera.fx == s->camera.fy && focal >= 0.4999 * height && focal <= 4.0001 * height,
            "a focal length that was not tried");
    REQUIRE(s->camera.cx == s->focal.width / 2 && s->camera.cy == s->focal.height / 2,
            "the principal point is not the middle");
}

static void check_misfits(const edml_focal *focal)
{
    for (int n = 0; n < EDML_FOCAL_LENGTHS; n++)
        REQUIRE(from_api(focal->misfit[n]) >= -TINY_METRE && from_api(focal->misfit[n]) <= 4 + TINY_METRE,
                "a misfit out of range");
}

void FUZZ_TARGET(focal)(choices *from)
{
    scene_before_camera scene;
    snapshot before;
    search s;
    memset(&s, 0xA5, sizeof s);
    draw_scene(&scene, from);
    double width = 2 * from_pixels(scene.camera.cx), height = 2 * from_pixels(scene.camera.cy);
    if (draw_one_in(from, 16)) width = draw_extreme(from);
    if (start(&s, width, height) != EDML_OK) return;
    for (uint32_t n = 1 + draw_below(from, 3); n > 0; n--) {
        const edml_focal focal = s.focal;
        take_snapshot(&before, &s, sizeof s);
        const edml_status status = edml_focal_add(&s.focal, &scene.pose, scene.in, &work, sizeof work);
        if (check_status(status, PLACE_CAUSES, &before)) {
            REQUIRE(s.focal.poses == focal.poses + 1, "a pose was not counted");
            check_misfits(&s.focal);
            check_camera(&s);
        }
#ifdef EDML_FUZZ_Q
        search watched = {focal, {0, 0, 0, 0}};
        const edml_status both = status == EDML_OK ? edml_focal_camera(&s.camera, &s.focal) : status;
        WATCH(both, checked_focal_add(&watched.focal, &watched.camera, &scene.pose, scene.in, &taken),
              &s.camera, &watched.camera, sizeof s.camera);
#endif
        if (n > 1) draw_scene(&scene, from);
    }
}
