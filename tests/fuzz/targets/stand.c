/* edml_stand() of any pose on any floor.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS stand
#include "../native.h"

enum { CAUSES = ALLOW(EDML_ERR_NOT_FINITE) | ALLOW(EDML_ERR_DEGENERATE) };

/* It is turned and lifted, no more: joints are as far from each other, and no mirror image. */
static void check_shape(const place3 y[EDML_JOINTS], const edml_pose *pose)
{
    const double rounding = IS_EXACT ? 2e-5 : 2e-4;
    place3 x[EDML_JOINTS];
    for (int j = 0; j < EDML_JOINTS; j++) x[j] = from_point(pose->joint[j]);
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = 0; j < i; j++)
            REQUIRE(fabs(distance_of(x[i], x[j]) - distance_of(y[i], y[j])) <= rounding, "another shape");
}

static double volume_of(const place3 x[EDML_JOINTS])
{
    const place3 o = x[EDML_NECK_BASE], a = x[EDML_R_KNEE], b = x[EDML_L_WRIST], c = x[EDML_HEAD];
    const double ax = a.x - o.x, ay = a.y - o.y, az = a.z - o.z, bx = b.x - o.x, by = b.y - o.y,
                 bz = b.z - o.z, cx = c.x - o.x, cy = c.y - o.y, cz = c.z - o.z;
    return ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx);
}

void FUZZ_TARGET(stand)(choices *from)
{
    place3 x[EDML_JOINTS], y[EDML_JOINTS], up;
    edml_point out[EDML_JOINTS], watched[EDML_JOINTS];
    edml_pose pose;
    snapshot before;
    draw_pose(x, from);
    to_pose(&pose, x, from);
    draw_up(&up, from);
    memset(out, 0xA5, sizeof out);
    memset(watched, 0xA5, sizeof watched);
    take_snapshot(&before, out, sizeof out);
    const edml_status status = edml_stand(out, &pose, to_point(up));
    (void)watched;
    WATCH(status, checked_stand(watched, &pose, to_point(up), &taken), out, watched, sizeof out);
    if (!check_status(status, CAUSES, &before)) return;
    for (int j = 0; j < EDML_JOINTS; j++) {
        x[j] = from_point(pose.joint[j]);
        y[j] = from_point(out[j]);
    }
    const double rounding = IS_EXACT ? 2e-5 : 2e-4;
    const double lower = fmin(y[EDML_R_ANKLE].y, y[EDML_L_ANKLE].y);
    REQUIRE(fabs(lower - 0.07) <= rounding, "the lower foot does not stand on the floor");
    check_shape(y, &pose);
    REQUIRE(fabs(volume_of(x) - volume_of(y)) <= 200 * rounding, "a mirror image");
}
