/* edml_quality() of any pose.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS quality
#include "../native.h"

enum { CAUSES = ALLOW(EDML_ERR_NOT_FINITE) | ALLOW(EDML_ERR_TOO_FEW_JOINTS) | ALLOW(EDML_ERR_ARGUMENT) };

static int count_seen_of(const edml_pose *pose)
{
    int count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) count += pose->seen >> j & 1;
    return count;
}

#define ROUNDING 2e-7 /* of 1 + a / sqrt(1 + a^2), two of its last places */

/* What is worse has no better quality: a larger misfit, and a joint less. */
static void check_order(api_real quality, edml_pose pose, choices *from)
{
    api_real other;
    pose.misfit += to_api(draw_magnitude(from, 1e-4, 0.3));
    const edml_status status = edml_quality(&other, &pose);
    REQUIRE(status == EDML_OK && from_api(other) <= from_api(quality) + ROUNDING,
            "a larger misfit has a better quality");
    pose.seen = (uint16_t)(pose.seen & (pose.seen - 1));
    if (edml_quality(&quality, &pose) == EDML_OK)
        REQUIRE(from_api(quality) <= from_api(other) + ROUNDING, "a joint less has a better quality");
}

void FUZZ_TARGET(quality)(choices *from)
{
    place3 x[EDML_JOINTS];
    edml_pose pose;
    api_real quality = to_api(7), watched = quality;
    snapshot before;
    draw_pose(x, from);
    to_pose(&pose, x, from);
    take_snapshot(&before, &quality, sizeof quality);
    const edml_status status = edml_quality(&quality, &pose);
    (void)watched;
    WATCH(status, checked_quality(&watched, &pose, &taken), &quality, &watched, sizeof quality);
    REQUIRE(status != EDML_ERR_ARGUMENT || !(pose.misfit >= 0), "a status without a cause");
    if (!check_status(status, CAUSES, &before)) return;
    REQUIRE(count_seen_of(&pose) >= 10, "a quality of too few joints");
    REQUIRE(from_api(quality) >= 0 && from_api(quality) <= 1, "a bad quality");
    if (from_api(pose.misfit) < 10) check_order(quality, pose, from);
}
