/* Names, models and tables: functions of a number, a text or a constant.
 *
 * SPDX-License-Identifier: MIT
 */
#define NAME_OF_THIS names
#include "../native.h"

static const edml_model *const models[] = {
    &edml_direct_f32,    &edml_direct_w16,   &edml_direct_w8, &edml_distances_f32,
    &edml_distances_w16, &edml_distances_w8, &edml_fconn_f32, &edml_fconn_w16,
    &edml_fconn_w8,      &edml_fconv_f32,    &edml_fconv_w8,
};

static void check_number(int number)
{
    const int is_joint = number >= 0 && number < EDML_JOINTS,
              is_angle = number >= 0 && number < EDML_ANGLES;
    REQUIRE((strcmp(edml_joint_name(number), "?") == 0) == !is_joint, "a name of no joint");
    REQUIRE((strcmp(edml_angle_name(number), "?") == 0) == !is_angle, "a name of no angle");
    REQUIRE((strcmp(edml_status_name((edml_status)number), "?") == 0) ==
                (number > 0 || number < EDML_ERR_BODY),
            "a name of no status");
}

/* A format's name, now and then cut or changed. */
static void check_formats(choices *from)
{
    char name[32] = "";
    int known = 0;
    while (edml_formats[known] != NULL) known++;
    strncpy(name, edml_formats[draw_below(from, (uint32_t)known)]->name, sizeof name - 1);
    if (draw_one_in(from, 2)) name[draw_below(from, 12)] = (char)draw_bits(from, 1);
    const edml_format *found = edml_format_find(name);
    REQUIRE(found == NULL || strcmp(found->name, name) == 0, "another format");
    for (int n = 0; n < known; n++)
        REQUIRE(strcmp(edml_formats[n]->name, name) != 0 || found == edml_formats[n],
                "a format was not found");
}

/* A checksum that is off by a bit is not the model's. */
static void check_models(choices *from)
{
    const edml_model *model = models[draw_below(from, 9)]; /* without the megabytes of FConv */
    edml_model damaged = *model;
    damaged.checksum ^= 1U << draw_below(from, 32);
    REQUIRE(strlen(edml_model_name(model)) > 4, "a model without a name");
    REQUIRE(edml_model_work_bytes(model) <= sizeof(edml_work) &&
                edml_model_work_bytes_q(model) <= sizeof(edml_work_q),
            "a model that edml_work is too small for");
    if (!draw_one_in(from, 64)) return; /* which reads all weights */
    REQUIRE(edml_model_check(model) == EDML_OK, "a shipped model is damaged");
    REQUIRE(edml_model_check(&damaged) == EDML_ERR_MODEL, "a damaged model passes");
}

static void check_uncertainty(uint16_t seen)
{
    uint8_t millimetres[EDML_JOINTS];
    snapshot before;
    int count = 0;
    for (int j = 0; j < EDML_JOINTS; j++) count += seen >> j & 1;
    memset(millimetres, 0, sizeof millimetres);
    take_snapshot(&before, millimetres, sizeof millimetres);
    const edml_status status = edml_uncertainty(millimetres, seen);
    REQUIRE((status == EDML_OK) == (count >= 10), "refused without a cause");
    if (!check_status(status, ALLOW(EDML_ERR_TOO_FEW_JOINTS), &before)) return;
    for (int j = 0; j < EDML_JOINTS; j++) REQUIRE(millimetres[j] > 0, "a joint is exact");
}

void fuzz_names(choices *from)
{
    const int near = (int)draw_bits(from, 1) - 32, any = (int)draw_bits(from, 4);
    check_number(draw_one_in(from, 2) ? near : any);
    check_formats(from);
    check_models(from);
    check_uncertainty((uint16_t)draw_bits(from, 2));
}
