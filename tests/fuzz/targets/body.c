/* edml_fit_body() with any measures, and edml_measure_body() of any poses.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS body
#include "../native.h"

enum { CAUSES = ALLOW(EDML_ERR_NOT_FINITE) | ALLOW(EDML_ERR_DEGENERATE) };

static place3 bone_of(const edml_pose *pose, int n)
{
    const place3 a = from_point(pose->joint[edml_bones[n].from]),
                 b = from_point(pose->joint[edml_bones[n].to]);
    const place3 bone = {b.x - a.x, b.y - a.y, b.z - a.z};
    return bone;
}

static double length_of(place3 a) { return sqrt(a.x * a.x + a.y * a.y + a.z * a.z); }

static void draw_body(edml_body *body, choices *from)
{
    const int wild = draw_one_in(from, 8);
    memset(body, 0, sizeof *body);
    if (draw_one_in(from, 2))
        body->height = to_api(wild ? draw_between(from, 0, 3) : draw_between(from, 1, 2.1));
    const double size = draw_between(from, 0.8, 1.2);
    for (int n = 0; n < EDML_BONES; n++) {
        static const double usual[] = {0.3,  0.2, 0.3,  0.28, 0.2, 0.3, 0.28,
                                       0.45, 0.4, 0.42, 0.45, 0.4, 0.42};
        if (draw_one_in(from, 2)) continue;
        body->bone[n] = to_api(size * usual[n] *
                               (wild ? draw_magnitude(from, 0.5, 2) : draw_between(from, 0.9, 1.1)));
    }
    if (!draw_one_in(from, 32)) return;
    *(draw_one_in(from, 4) ? &body->height
                           : &body->bone[draw_below(from, EDML_BONES)]) = to_api(draw_extreme(from));
}

/* Known bones have their length, the others have all grown by one factor, and all point where they did. */
static void check_fit(const edml_pose *fitted, const edml_pose *pose, const edml_body *body)
{
    double factor = 0;
    for (int n = 0; n < EDML_BONES; n++) {
        const place3 was = bone_of(pose, n), is = bone_of(fitted, n);
        const double before = length_of(was), now = length_of(is), known = from_api(body->bone[n]);
        const double rounding = 4 * TINY_METRE * (1 + now) *
                                (1 + (IS_EXACT ? 0 : now / fmax(before, 1e-9)));
        if (known != 0) REQUIRE(fabs(now - known) <= rounding, "a known bone has another length");
        const double along = was.x * is.x + was.y * is.y + was.z * is.z;
        REQUIRE(before < 0.02 || along >= before * now - 4 * before * rounding, "a bone points elsewhere");
        if (known == 0 && before > 0.1) {
            const double grown = now / before;
            REQUIRE(factor == 0 || fabs(grown - factor) <= 40 * rounding, "two bones grew by two factors");
            factor = grown;
        }
    }
    const place3 right = from_point(fitted->joint[EDML_R_HIP]),
                 left = from_point(fitted->joint[EDML_L_HIP]);
    REQUIRE(fabs(right.x + left.x) + fabs(right.y + left.y) + fabs(right.z + left.z) <= 60 * TINY_METRE,
            "mid-hip is not the origin");
    REQUIRE(memcmp(&fitted->misfit, &pose->misfit, sizeof pose->misfit) == 0 && fitted->seen == pose->seen,
            "more than the joints was changed");
    if (body->height == 0 && factor != 0) REQUIRE(fabs(factor - 1) <= 0.001, "bones of no known size grew");
}

static void fit(const edml_pose *pose, const edml_body *body, unsigned causes)
{
    edml_pose fitted = *pose;
    snapshot before;
    take_snapshot(&before, &fitted, sizeof fitted);
    const edml_status status = edml_fit_body(&fitted, body);
#ifdef EDML_FUZZ_Q
    edml_pose watched = *pose;
    WATCH(status, checked_fit_body(&watched, body, &taken), &fitted, &watched, offsetof(edml_pose, seen));
#endif
    if (check_status(status, causes, &before)) check_fit(&fitted, pose, body);
}

void FUZZ_TARGET(body)(choices *from)
{
    place3 x[EDML_JOINTS];
    edml_pose pose;
    edml_body body;
    edml_measured_body measured;
    snapshot before;
    memset(&measured, 0xFF, sizeof measured);
    edml_measure_start(&measured);
    for (uint32_t n = 1 + draw_below(from, 4); n > 0; n--) {
        draw_pose(x, from);
        to_pose(&pose, x, from);
        draw_body(&body, from);
        fit(&pose, &body, CAUSES | ALLOW(EDML_ERR_BODY));
        const edml_measured_body so_far = measured;
        take_snapshot(&before, &measured, sizeof measured);
        const edml_status status = edml_measure_body(&measured, &pose);
#ifdef EDML_FUZZ_Q
        edml_measured_body watched = so_far;
        WATCH(status, checked_measure_body(&watched, &pose, &taken), &measured, &watched, sizeof watched);
#endif
        if (!check_status(status, CAUSES, &before)) continue;
        REQUIRE(measured.poses == so_far.poses + 1 && measured.body.height == 0, "a pose was not counted");
        fit(&pose, &measured.body, CAUSES); /* it is always a body */
    }
}
