/* edml_joint_limits() and edml_reflect_by_joint_limits() of any pose.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS joint_limits
#include "../native.h"

static edml_pose reflection_of(const edml_pose *pose)
{
    edml_pose other = *pose;
    for (int j = 0; j < EDML_JOINTS; j++) other.joint[j].z = -pose->joint[j].z;
    return other;
}

/* It is the pose or its reflection, the one of fewer violations, and `fewer` says by how many. */
static void check_reflection(const edml_pose *pose, int violations)
{
    const edml_pose mirrored = reflection_of(pose);
    edml_pose chosen = *pose;
    int fewer = -1, reflected = -1;
    const edml_status status = edml_reflect_by_joint_limits(&fewer, &chosen);
    REQUIRE(status == EDML_OK && edml_joint_limits(&reflected, &mirrored) == EDML_OK,
            "refused its reflection");
#ifdef EDML_FUZZ_Q
    edml_pose watched = *pose;
    int other = -1;
    WATCH(status, checked_reflect_by_joint_limits(&other, &watched, &taken), &chosen, &watched,
          offsetof(edml_pose, seen));
#endif
    REQUIRE(fewer == (reflected > violations ? reflected - violations : violations - reflected),
            "another number of fewer violations");
    REQUIRE(are_same_poses(&chosen, reflected < violations ? &mirrored : pose), "not the better one");
}

void FUZZ_TARGET(joint_limits)(choices *from)
{
    place3 x[EDML_JOINTS];
    struct {
        edml_pose pose;
        int violations, fewer;
    } out;
    snapshot before;
    int watched = -7;
    memset(&out, 0, sizeof out);
    draw_pose(x, from);
    to_pose(&out.pose, x, from);
    out.violations = out.fewer = -7;
    take_snapshot(&before, &out, sizeof out);
    const edml_status status = edml_joint_limits(&out.violations, &out.pose);
    (void)watched;
    WATCH(status, checked_joint_limits(&watched, &out.pose, &taken), &out.violations, &watched,
          sizeof watched);
    if (check_status(status, ALLOW(EDML_ERR_NOT_FINITE), &before)) {
        REQUIRE(out.violations >= 0 && out.violations <= 9, "a bad number of violations");
        check_reflection(&out.pose, out.violations);
    } else {
        check_status(edml_reflect_by_joint_limits(&out.fewer, &out.pose), ALLOW(EDML_ERR_NOT_FINITE),
                     &before);
    }
}
