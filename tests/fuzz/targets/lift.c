/* edml_lift() of any frame by any model; by FConv in fconv.c, because that takes hundreds of times as long.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef NAME_OF_THIS
#define NAME_OF_THIS lift
#define DRAW_MODEL(from) draw_model(from)
#endif
#include "../native.h"

static edml_fconv_work work;

enum { CAUSES = ALLOW(EDML_ERR_NOT_FINITE) | ALLOW(EDML_ERR_TOO_FEW_JOINTS) | ALLOW(EDML_ERR_DEGENERATE) };

static edml_status lift_again(edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_point *up,
                              const edml_model *model)
{
    memset(&work, 0x5A, sizeof work);
    return edml_lift(pose, in, up, model, &work, sizeof work);
}

/* Confidences above 0 and what was not seen change nothing. */
static void check_confidences(const edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                              const edml_point *up, const edml_model *model, choices *from)
{
    edml_keypoint other[EDML_JOINTS];
    edml_pose found;
    memcpy(other, in, sizeof other);
    for (int j = 0; j < EDML_JOINTS; j++) {
        if (in[j].c > 0) {
            other[j].c = 1;
            continue;
        }
        other[j].x = to_pixels(draw_extreme(from));
        other[j].y = to_pixels(draw_extreme(from));
    }
    REQUIRE(lift_again(&found, other, up, model) == EDML_OK, "refused for its confidences");
    REQUIRE(are_same_poses(pose, &found), "confidences, or what was not seen, change a pose");
}

/* Coordinates that lose nothing by it, moved and scaled by a power of two, are lifted to the same bits. */
static void check_scale_and_offset(const sighting frame[EDML_JOINTS], const edml_point *up,
                                   const edml_model *model, choices *from)
{
    sighting given[EDML_JOINTS];
    edml_keypoint in[EDML_JOINTS];
    edml_pose expected, found;
    memcpy(given, frame, sizeof given);
    round_sightings(given);
    to_keypoints(in, given, EDML_JOINTS);
    if (lift_again(&expected, in, up, model) != EDML_OK) return;
    const double x = (double)draw_below(from, 4096) - 2048, y = (double)draw_below(from, 4096) - 2048;
    const double scale = ldexp(1, (int)draw_below(from, IS_EXACT ? 200 : 8) - (IS_EXACT ? 100 : 7));
    for (int j = 0; j < EDML_JOINTS; j++) {
        given[j].x = scale * (given[j].x + x);
        given[j].y = scale * (given[j].y + y);
    }
    to_keypoints(in, given, EDML_JOINTS);
    const edml_status status = lift_again(&found, in, up, model);
    if (status == EDML_ERR_DEGENERATE) return; /* small beside its coordinates, or in pixels */
    REQUIRE(status == EDML_OK, "refused elsewhere");
    REQUIRE(are_same_poses(&expected, &found), "another pose elsewhere, or of another scale");
}

/* A camera that is rolled by a quarter turn sees the pose rolled, in float to the bit.  Where the body has no axis
 * in the image, nothing says how it is rolled. */
static void check_roll(const edml_pose *pose, const edml_keypoint in[EDML_JOINTS], const edml_point *up,
                       const edml_model *model)
{
    edml_keypoint turned[EDML_JOINTS];
    edml_image image;
    edml_pose found;
    if (!IS_EXACT || edml_body_frame(&image, in, 1, model->imputation) != EDML_OK) return;
    if (image.down.u == 0) return;
    for (int j = 0; j < EDML_JOINTS; j++) {
        turned[j] = in[j];
        turned[j].x = -in[j].y;
        turned[j].y = in[j].x;
    }
    const edml_point upwards = {up == NULL ? 0 : -up->y, up == NULL ? 0 : up->x, up == NULL ? 0 : up->z};
    REQUIRE(lift_again(&found, turned, up == NULL ? NULL : &upwards, model) == EDML_OK,
            "refused when rolled");
    for (int j = 0; j < EDML_JOINTS; j++) {
        const edml_point a = pose->joint[j], b = found.joint[j];
        REQUIRE(b.x == -a.y && b.y == a.x && b.z == a.z, "another pose of a rolled camera");
    }
    REQUIRE(pose->misfit == found.misfit, "another misfit of a rolled camera");
}

/* A mirror image is lifted to the mirror image, if the network treats right and left alike. */
static void check_mirror(const edml_pose *pose, const edml_keypoint in[EDML_JOINTS],
                         const edml_model *model)
{
    edml_keypoint mirrored[EDML_JOINTS];
    edml_image image;
    edml_pose found;
    if (edml_body_frame(&image, in, 1, model->imputation) != EDML_OK) return;
    for (int j = 0; j < EDML_JOINTS; j++) {
        mirrored[j] = in[edml_mirror_joint[j]];
        mirrored[j].x = to_pixels(-from_pixels(mirrored[j].x));
    }
    if (lift_again(&found, mirrored, NULL, model) != EDML_OK) return; /* at a border */
    for (int j = 0; j < EDML_JOINTS; j++) {
        place3 a = from_point(pose->joint[edml_mirror_joint[j]]);
        a.x = -a.x;
        REQUIRE(distance_of(a, from_point(found.joint[j])) < 0.05, "another pose of a mirror image");
    }
}

void FUZZ_NAME(NAME_OF_THIS)(choices *from)
{
    sighting frame[EDML_JOINTS];
    edml_keypoint in[EDML_JOINTS];
    edml_pose pose, watched;
    snapshot before;
    place3 upwards;
    const uint32_t further = draw_bits(from, 1);
    const edml_model *model = DRAW_MODEL(from);
    const int knows_up = draw_up(&upwards, from);
    const edml_point up = to_point(upwards), *const above = knows_up ? &up : NULL;
    draw_frame(frame, from);
    to_keypoints(in, frame, EDML_JOINTS);
    memset(&pose, 0xA5, sizeof pose);
    memset(&watched, 0xA5, sizeof watched);
    memset(&work, (int)further, sizeof work);
    take_snapshot(&before, &pose, sizeof pose);
    const edml_status status = edml_lift(&pose, in, above, model, &work, sizeof work);
    (void)watched;
    WATCH(status, checked_lift(&watched, in, above, model, &taken), &pose, &watched,
          offsetof(edml_pose, seen));
    if (further % 8 == 0) check_scale_and_offset(frame, above, model, from);
    if (!check_status(status, CAUSES, &before)) return;
    check_pose(&pose);
    REQUIRE(pose.seen == seen_of(in), "another seen mask");
    if (further % 8 == 1) check_confidences(&pose, in, above, model, from);
    if (further % 8 == 2) check_roll(&pose, in, above, model);
    if (further % 8 == 3 && above == NULL && model->gives == (EDML_GIVES_POINTS | EDML_GIVES_GATES))
        check_mirror(&pose, in, model);
}
