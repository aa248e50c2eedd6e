/* The angles of an answer: fields behind the others, or a member.
 *
 * SPDX-License-Identifier: MIT
 */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "edmlift/angles.h"
#include "lift_stdin.h"

static int32_t to_q16(float value) { return (int32_t)lrint(65536.0 * (double)value); }

/* The numbers of an answer in fixed point are those of Q16, which a float holds. */
static edml_status measure_fixed(float degrees[EDML_ANGLES], const edml_pose *pose, const edml_point *up)
{
    edml_pose_q given = {.seen = pose->seen};
    int32_t found[EDML_ANGLES];
    edml_point_q upwards = {0, 0, 0};
    for (int j = 0; j < EDML_JOINTS; j++) {
        given.joint[j].x = to_q16(pose->joint[j].x);
        given.joint[j].y = to_q16(pose->joint[j].y);
        given.joint[j].z = to_q16(pose->joint[j].z);
    }
    if (up != NULL) {
        upwards.x = to_q16(up->x);
        upwards.y = to_q16(up->y);
        upwards.z = to_q16(up->z);
    }
    const edml_status status = edml_angles_q(found, &given, up != NULL ? &upwards : NULL);
    for (int n = 0; n < EDML_ANGLES && status == EDML_OK; n++)
        degrees[n] = found[n] == EDML_NO_ANGLE ? NAN : (float)(found[n] / 65536.0);
    return status;
}

/* Returns 0 if there are none. */
static int measure(float degrees[EDML_ANGLES], const answer *out, const options *set)
{
    const edml_point *up = knows_up(set) ? &set->up : NULL;
    if (strcmp(out->status, "ok") != 0) return 0;
    return (set->fixed ? measure_fixed : edml_angles)(degrees, &out->pose, up) == EDML_OK;
}

void write_angle_names(void)
{
    for (int n = 0; n < EDML_ANGLES; n++) printf(",%s", edml_angle_name(n));
}

void write_angle_fields(const answer *out, const options *set)
{
    float degrees[EDML_ANGLES];
    const int measured = measure(degrees, out, set);
    for (int n = 0; n < EDML_ANGLES; n++)
        if (measured && !isnan(degrees[n]))
            printf(",%.6g", (double)degrees[n]);
        else
            putchar(',');
}

void write_angle_member(const answer *out, const options *set)
{
    float degrees[EDML_ANGLES];
    if (!measure(degrees, out, set)) {
        fputs(",\"angles\":null", stdout);
        return;
    }
    for (int n = 0; n < EDML_ANGLES; n++) {
        printf("%s\"%s\":", n == 0 ? ",\"angles\":{" : ",", edml_angle_name(n));
        if (isnan(degrees[n]))
            fputs("null", stdout);
        else
            printf("%.6g", (double)degrees[n]);
    }
    putchar('}');
}
