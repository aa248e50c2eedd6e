/* edml_path_follow() of people who stay, walk, leap and are lost, at any times.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS path
#include "../native.h"

enum { CAUSES = ALLOW(EDML_ERR_NOT_FINITE) | ALLOW(EDML_ERR_CAMERA) | ALLOW(EDML_ERR_TIME), FRAMES = 12 };

typedef struct {
    edml_path path;
    edml_placement placement;
} followed;

static double limit_way(double a) { return fmax(-250, fmin(250, a)); }

/* The next place, from that of before. */
static void draw_way(place3 *at, choices *from)
{
    const double step = draw_magnitude(from, 1e-4, draw_one_in(from, 8) ? 100 : 1);
    at->x = limit_way(at->x + step * draw_between(from, -1, 1));
    at->y = limit_way(at->y + step * draw_between(from, -1, 1));
    at->z = limit_way(at->z + step * draw_between(from, -1, 1));
}

static void draw_placement(edml_placement *placement, place3 at, choices *from)
{
    memset(placement, 0x5A, sizeof *placement);
    placement->translation = to_point(at);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const place3 p = {at.x + draw_between(from, -1, 1), at.y + draw_between(from, -1, 1), at.z};
        placement->joint[j] = to_point(p);
    }
    if (draw_one_in(from, 32))
        placement->joint[draw_below(from, EDML_JOINTS)].x = to_api(draw_extreme(from));
    if (draw_one_in(from, 32)) placement->translation.y = to_api(draw_extreme(from));
}

static uint32_t draw_time(uint32_t last, choices *from)
{
    static const uint32_t steps[] = {33, 33, 33, 33, 17, 1, 0, 999, 1000, 1001, UINT32_MAX, 1U << 31};
    return last + (draw_one_in(from, 2)   ? 33
                   : draw_one_in(from, 2) ? draw_below(from, 300)
                                          : steps[draw_below(from, 12)]);
}

/* Joints have gone the way of the translation, and nothing else has changed. */
static void check_move(const edml_placement *now, const edml_placement *before, const edml_path *path)
{
    const place3 to = from_point(now->translation), at = from_point(before->translation),
                 held = from_point(path->at);
    REQUIRE(distance_of(to, held) == 0, "the placement is not where the path is");
    for (int j = 0; j < EDML_JOINTS; j++) {
        place3 joint = from_point(before->joint[j]);
        joint.x += to.x - at.x;
        joint.y += to.y - at.y;
        joint.z += to.z - at.z;
        REQUIRE(distance_of(joint, from_point(now->joint[j])) < 1e-4, "a joint went another way");
    }
    REQUIRE(memcmp(now->rotation, before->rotation, sizeof now->rotation) == 0 &&
                memcmp(&now->reprojection, &before->reprojection, sizeof now->reprojection) == 0 &&
                now->steps == before->steps,
            "more than places were changed");
}

static void check_path(const edml_path *path, uint32_t time_ms)
{
    const place3 at = from_point(path->at), rate = from_point(path->rate);
    REQUIRE(fabs(at.x) <= 100 && fabs(at.y) <= 100 && fabs(at.z) <= 100, "the path is beyond 100 m");
    REQUIRE(fabs(rate.x) + fabs(rate.y) + fabs(rate.z) <= 72.1, "the path is faster than anybody");
    REQUIRE(path->placements > 0 && path->time == time_ms, "a placement was not counted");
}

void FUZZ_TARGET(path)(choices *from)
{
    followed now, before;
    snapshot saved;
    place3 at = {draw_between(from, -5, 5), draw_between(from, -2, 2), draw_magnitude(from, 0.1, 100)};
    uint32_t time_ms = draw_one_in(from, 2) ? UINT32_MAX - 50 : draw_bits(from, 4);
    memset(&now, 0, sizeof now);
    edml_path_start(&now.path);
    for (int n = 0; n < FRAMES; n++) {
        draw_placement(&now.placement, at, from);
        before = now;
        take_snapshot(&saved, &now, sizeof now);
        const edml_status status = edml_path_follow(&now.path, &now.placement, time_ms);
#ifdef EDML_FUZZ_Q
        followed watched = before;
        WATCH(status, checked_path_follow(&watched.path, &watched.placement, time_ms, &taken), &now,
              &watched, offsetof(edml_path, placements));
#endif
        if (check_status(status, CAUSES, &saved)) {
            check_move(&now.placement, &before.placement, &now.path);
            check_path(&now.path, time_ms);
            if (before.path.placements == 0)
                REQUIRE(memcmp(&now.placement.translation, &before.placement.translation,
                               sizeof now.placement.translation) == 0,
                        "the first placement was moved");
        }
        draw_way(&at, from);
        time_ms = draw_time(time_ms, from);
    }
}
