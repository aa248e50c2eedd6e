/* edml_angles() of any pose.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS angles
#include "../native.h"

enum { CAUSES = ALLOW(EDML_ERR_NOT_FINITE) | ALLOW(EDML_ERR_DEGENERATE) };

static const struct {
    int least, most;
} ranges[EDML_ANGLES] = {
    {0, 180},   {0, 180},   {0, 180}, {0, 180},    {-180, 180}, {-180, 180}, {-90, 90},
    {-90, 90},  {0, 180},   {0, 180}, {-180, 180}, {-180, 180}, {-90, 270},  {-90, 270},
    {-90, 270}, {-90, 270}, {0, 180}, {-180, 180}, {-90, 90},   {-180, 180},
};

/* The angle of the same name on the other side. */
static int other_side(int angle) { return angle < EDML_TRUNK_LEAN ? angle ^ 1 : angle; }

/* A mirror image has the angles of the other side; what leans to the right leans to the left.  Angles that are none
 * are the same, but for those at a border. */
static void check_mirror(const api_real degrees[EDML_ANGLES], const edml_pose *pose, const edml_point *up)
{
    edml_pose mirrored = *pose;
    edml_point other_up = {0, 0, 0};
    api_real found[EDML_ANGLES];
    if (up != NULL) other_up = *up;
    other_up.x = -other_up.x;
    mirrored.seen = 0;
    for (int j = 0; j < EDML_JOINTS; j++) {
        const int k = edml_mirror_joint[j];
        mirrored.joint[j] = pose->joint[k];
        mirrored.joint[j].x = -mirrored.joint[j].x;
        mirrored.seen = (uint16_t)(mirrored.seen | (pose->seen >> k & 1) << j);
    }
    REQUIRE(edml_angles(found, &mirrored, up != NULL ? &other_up : NULL) == EDML_OK,
            "a mirror image is refused");
    for (int n = 0; n < EDML_ANGLES; n++) {
        const api_real a = degrees[n], b = found[other_side(n)];
        if (IS_NO_ANGLE(a) || IS_NO_ANGLE(b)) continue;
        const double sign = n == EDML_TRUNK_LEAN_RIGHT || n == EDML_HEADING ? -1 : 1;
        const double off = fabs(remainder(from_api(a) - sign * from_api(b), 360));
        REQUIRE(off <= (IS_EXACT ? 0.01 : 1), "another angle of a mirror image");
    }
}

void FUZZ_TARGET(angles)(choices *from)
{
    place3 x[EDML_JOINTS], upwards;
    api_real degrees[EDML_ANGLES], watched[EDML_ANGLES];
    edml_pose pose;
    snapshot before;
    draw_pose(x, from);
    to_pose(&pose, x, from);
    const int knows_up = draw_up(&upwards, from);
    const edml_point up = to_point(upwards), *const above = knows_up ? &up : NULL;
    memset(degrees, 0x5A, sizeof degrees);
    memset(watched, 0x5A, sizeof watched);
    take_snapshot(&before, degrees, sizeof degrees);
    const edml_status status = edml_angles(degrees, &pose, above);
    (void)watched;
    WATCH(status, checked_angles(watched, &pose, above, &taken), degrees, watched, sizeof degrees);
    if (!check_status(status, CAUSES, &before)) return;
    for (int n = 0; n < EDML_ANGLES; n++) {
        if (IS_NO_ANGLE(degrees[n])) continue;
        const double angle = from_api(degrees[n]);
        REQUIRE(angle >= ranges[n].least && angle <= ranges[n].most, edml_angle_name(n));
    }
    check_mirror(degrees, &pose, above);
}
