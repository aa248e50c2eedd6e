/* Scenes before a camera, and what is demanded of a placement in them.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef EDML_FUZZ_PLACEMENT_H
#define EDML_FUZZ_PLACEMENT_H

#include "native.h"

enum {
    PLACE_CAUSES = ALLOW(EDML_ERR_NOT_FINITE) | ALLOW(EDML_ERR_TOO_FEW_JOINTS) |
                   ALLOW(EDML_ERR_DEGENERATE) | ALLOW(EDML_ERR_CAMERA)
};

/* How far a rotation may be from one.  In Q16 the last places of three components leave 2.6e-5. */
#define ROTATION_DEFECT (IS_EXACT ? 1e-5 : 3e-5)

typedef struct {
    edml_pose pose;
    edml_keypoint in[EDML_JOINTS];
    edml_camera camera;
} scene_before_camera;

/* A pose, and keypoints of it, or of another one, by the camera. */
static inline void draw_scene(scene_before_camera *scene, choices *from)
{
    place3 x[EDML_JOINTS], far;
    pinhole by;
    sighting seen[EDML_JOINTS];
    draw_pose(x, from);
    to_pose(&scene->pose, x, from);
    draw_camera(&by, &far, from);
    const uint32_t other = draw_below(from, 8);
    if (other == 0) draw_points(x, from);
    for (int j = 0; j < EDML_JOINTS && other == 1; j++) x[j].z = -x[j].z;
    draw_sightings(seen, x, &by, far, from);
    if (draw_one_in(from, 16)) draw_camera(&by, &far, from);
    to_keypoints(scene->in, seen, EDML_JOINTS);
    scene->camera = to_camera(by);
}

static inline place3 turned(const edml_placement *by, place3 p)
{
    const place3 x = from_point(by->rotation[0]), y = from_point(by->rotation[1]),
                 z = from_point(by->rotation[2]), t = from_point(by->translation);
    const place3 q = {x.x * p.x + x.y * p.y + x.z * p.z + t.x, y.x * p.x + y.y * p.y + y.z * p.z + t.y,
                      z.x * p.x + z.y * p.y + z.z * p.z + t.z};
    return q;
}

static inline void check_rotation(const edml_point rotation[3])
{
    place3 row[3];
    for (int i = 0; i < 3; i++) row[i] = from_point(rotation[i]);
    for (int i = 0; i < 3; i++)
        for (int k = 0; k <= i; k++)
            REQUIRE(fabs(row[i].x * row[k].x + row[i].y * row[k].y + row[i].z * row[k].z - (i == k)) <=
                        ROTATION_DEFECT,
                    "the rotation is none");
    const double determinant = row[0].x * (row[1].y * row[2].z - row[1].z * row[2].y) -
                               row[0].y * (row[1].x * row[2].z - row[1].z * row[2].x) +
                               row[0].z * (row[1].x * row[2].y - row[1].y * row[2].x);
    REQUIRE(determinant > 0, "the rotation is a reflection");
}

/* The RMS distance of the joints' images from the keypoints, of joints with a thousandth of all confidence.  NaN
 * where a rounding decides whether a joint has that. */
static inline double reprojection_of(const edml_placement *placement, const scene_before_camera *scene)
{
    double total = 0, sum = 0;
    for (int j = 0; j < EDML_JOINTS; j++)
        if (scene->in[j].c > 0) total += (double)scene->in[j].c;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const place3 p = from_point(placement->joint[j]);
        const double weight = (double)scene->in[j].c / total;
        if (fabs(1024 * weight - 1) < 1e-5) return NAN;
        if (!(weight > 1.0 / 1024)) continue;
        const double x = from_pixels(scene->camera.fx) * p.x / p.z + from_pixels(scene->camera.cx);
        const double y = from_pixels(scene->camera.fy) * p.y / p.z + from_pixels(scene->camera.cy);
        const double dx = x - from_pixels(scene->in[j].x), dy = y - from_pixels(scene->in[j].y);
        sum += weight * (dx * dx + dy * dy);
    }
    return sqrt(sum);
}

static inline void check_reprojection(const edml_placement *placement, const scene_before_camera *scene)
{
    double nearest = 1e9;
    for (int j = 0; j < EDML_JOINTS; j++) nearest = fmin(nearest, from_point(placement->joint[j]).z);
    const double found = from_pixels(placement->reprojection), wanted = reprojection_of(placement, scene);
    const double focal = fmax(from_pixels(scene->camera.fx), from_pixels(scene->camera.fy));
    const double rounding = (IS_EXACT ? 2e-5 : 2e-4) * focal * (1 + 1 / nearest) + 1e-4 * wanted;
    REQUIRE(found >= 0 && !(fabs(found - wanted) > rounding), "another reprojection error");
}

static inline void check_placement(const edml_placement *placement, const scene_before_camera *scene)
{
    check_rotation(placement->rotation);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const place3 p = from_point(placement->joint[j]);
        REQUIRE(p.z > 0 && p.z < 110 && fabs(p.x) < 250 && fabs(p.y) < 250, "a joint is out of sight");
        const double off = distance_of(p, turned(placement, from_point(scene->pose.joint[j])));
        REQUIRE(off <= (IS_EXACT ? 1e-4 : 5e-4), "a joint is not where rotation and translation have it");
    }
    REQUIRE(placement->steps <= 53, "too many steps");
    check_reprojection(placement, scene);
}

static inline int are_same_placements(const edml_placement *a, const edml_placement *b)
{
    return memcmp(a, b, offsetof(edml_placement, reprojection)) == 0 && a->steps == b->steps;
}

#endif
