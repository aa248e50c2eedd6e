/* edml_orient(), edml_mirror(), edml_align() and edml_fuse(): what follows the scaling.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS orient
#include "../native.h"

static edml_work work;

/* Points as edml_mds() gives them: of a pose, whose distances are up to 3 m, with errors. */
static void draw_scaled(point x[EDML_JOINTS], choices *from)
{
    place3 p[EDML_JOINTS];
    real distance[EDML_PAIRS];
    const double error = draw_one_in(from, 2) ? draw_magnitude(from, 1e-4, 1) : 0;
    draw_points(p, from);
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = i + 1; j < EDML_JOINTS; j++)
            distance[EDML_PAIR(i, j)] = to_real(
                fmin(3, fmax(0, distance_of(p[i], p[j]) + error * draw_between(from, -1, 1))));
    edml_mds(x, distance, &work);
}

static place3 place_of(point p)
{
    const place3 place = {from_real(p.x), from_real(p.y), from_real(p.z)};
    return place;
}

/* Turned, and no more. */
static void check_shape(const point x[EDML_JOINTS], const point before[EDML_JOINTS])
{
    place3 sum = {0, 0, 0};
    for (int i = 0; i < EDML_JOINTS; i++) {
        const place3 p = place_of(x[i]);
        sum.x += p.x;
        sum.y += p.y;
        sum.z += p.z;
        for (int j = 0; j < i; j++)
            REQUIRE(fabs(distance_of(p, place_of(x[j])) -
                         distance_of(place_of(before[i]), place_of(before[j]))) <= 1e-3,
                    "another shape");
    }
    REQUIRE(fabs(sum.x) + fabs(sum.y) + fabs(sum.z) <= 1e-3, "the mean is not the origin");
}

/* The same points, or all depths negated. */
static void check_mirror(point x[EDML_JOINTS], const edml_model *model)
{
    point before[EDML_JOINTS];
    memcpy(before, x, sizeof before);
    const double margin = from_real(edml_mirror(x, model));
    REQUIRE(margin >= 0 && margin < 128, "a bad margin");
    const int reflected = memcmp(x, before, sizeof before) != 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (reflected) before[j].z = -before[j].z;
        REQUIRE(x[j].x == before[j].x && x[j].y == before[j].y && x[j].z == before[j].z,
                "neither of two mirror images");
    }
}

/* Joints that were not seen stay, and none leaves the neighbourhood. */
static void check_fusion(point x[EDML_JOINTS], const edml_image *image, const edml_model *model,
                         choices *from)
{
    real share[EDML_JOINTS];
    point before[EDML_JOINTS];
    memcpy(before, x, sizeof before);
    for (int j = 0; j < EDML_JOINTS; j++) share[j] = to_real(draw_between(from, 0, 1));
    const double misfit = from_real(edml_fuse(x, image, share, model));
    REQUIRE(misfit >= 0 && misfit < 16, "a bad misfit");
    for (int j = 0; j < EDML_JOINTS; j++) {
        const place3 p = place_of(x[j]);
        REQUIRE(fabs(p.x) + fabs(p.y) + fabs(p.z) < 64, "a joint is far away");
        REQUIRE(image->seen >> j & 1 || memcmp(&x[j], &before[j], sizeof x[j]) == 0,
                "an unseen joint was moved");
    }
}

static void check_alignment(const point x[EDML_JOINTS], const edml_model *model, choices *from)
{
    place3 p[EDML_JOINTS];
    point onto[EDML_JOINTS], aligned[EDML_JOINTS];
    draw_points(p, from);
    for (int j = 0; j < EDML_JOINTS; j++) {
        onto[j].x = to_real(p[j].x);
        onto[j].y = to_real(p[j].y);
        onto[j].z = to_real(p[j].z);
    }
    memcpy(aligned, x, sizeof aligned);
    edml_align(aligned, onto, model);
    for (int j = 0; j < EDML_JOINTS; j++) {
        const double most = fmax(distance_of(place_of(x[j]), (place3){0, 0, 0}),
                                 distance_of(p[j], (place3){0, 0, 0}));
        REQUIRE(distance_of(place_of(aligned[j]), (place3){0, 0, 0}) <= most + 1e-3, "a mean beyond both");
    }
#ifdef EDML_FUZZ_Q
    point watched[EDML_JOINTS];
    memcpy(watched, x, sizeof watched);
    WATCH(EDML_OK, (checked_align(watched, onto, model, &taken), EDML_OK), aligned, watched,
          sizeof watched);
#endif
}

void FUZZ_TARGET(orient)(choices *from)
{
    sighting frame[EDML_JOINTS];
    edml_keypoint in[EDML_JOINTS];
    edml_image image;
    point x[EDML_JOINTS], before[EDML_JOINTS];
    snapshot saved;
    const edml_model *distances = IS_EXACT ? &edml_distances_f32 : &edml_distances_w16,
                     *fconn = &edml_fconn_w16;
    draw_scaled(x, from);
    draw_frame(frame, from);
    to_keypoints(in, frame, EDML_JOINTS);
    memset(&image, 0, sizeof image);
    if (edml_body_frame(&image, in, 5, &edml_default_imputation) != EDML_OK) return;
    check_alignment(x, distances, from);
    memcpy(before, x, sizeof before);
    take_snapshot(&saved, x, sizeof x);
    const edml_status status = edml_orient(x, &image);
#ifdef EDML_FUZZ_Q
    point watched[EDML_JOINTS];
    memcpy(watched, before, sizeof watched);
    WATCH(status, checked_orient(watched, &image, &taken), x, watched, sizeof watched);
#endif
    if (!check_status(status, ALLOW(EDML_ERR_DEGENERATE), &saved)) return;
    check_shape(x, before);
    check_mirror(x, fconn);
    check_fusion(x, &image, fconn, from);
}
