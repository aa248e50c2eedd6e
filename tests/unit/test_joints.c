/* joints/joints.c and status.c, and what the header alone promises.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "helpers.h"

static void each_joint_has_its_own_name(void)
{
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = 0; j < i; j++) TEST_ASSERT_TRUE(strcmp(edml_joint_name(i), edml_joint_name(j)) != 0);
}

static void names_follow_the_order_of_the_enumeration(void)
{
    TEST_ASSERT_EQUAL_STRING("head", edml_joint_name(EDML_HEAD));
    TEST_ASSERT_EQUAL_STRING("neck_base", edml_joint_name(EDML_NECK_BASE));
    TEST_ASSERT_EQUAL_STRING("right_shoulder", edml_joint_name(EDML_R_SHOULDER));
    TEST_ASSERT_EQUAL_STRING("right_wrist", edml_joint_name(EDML_R_WRIST));
    TEST_ASSERT_EQUAL_STRING("left_elbow", edml_joint_name(EDML_L_ELBOW));
    TEST_ASSERT_EQUAL_STRING("right_hip", edml_joint_name(EDML_R_HIP));
    TEST_ASSERT_EQUAL_STRING("left_knee", edml_joint_name(EDML_L_KNEE));
    TEST_ASSERT_EQUAL_STRING("left_ankle", edml_joint_name(EDML_L_ANKLE));
    TEST_ASSERT_EQUAL_INT(14, EDML_JOINTS);
}

static void joints_that_do_not_exist_have_the_name_of_none(void)
{
    TEST_ASSERT_EQUAL_STRING("?", edml_joint_name(-1));
    TEST_ASSERT_EQUAL_STRING("?", edml_joint_name(EDML_JOINTS));
    TEST_ASSERT_EQUAL_STRING("?", edml_joint_name(-2147483647 - 1));
    TEST_ASSERT_EQUAL_STRING("?", edml_joint_name(2147483647));
}

static void mirroring_twice_changes_nothing(void)
{
    for (int j = 0; j < EDML_JOINTS; j++) TEST_ASSERT_EQUAL_INT(j, edml_mirror_joint[edml_mirror_joint[j]]);
}

static void mirroring_swaps_right_and_left_in_the_name(void)
{
    for (int j = 0; j < EDML_JOINTS; j++) {
        const char *name = edml_joint_name(j), *other = edml_joint_name(edml_mirror_joint[j]);
        if (strncmp(name, "right_", 6) == 0) {
            TEST_ASSERT_EQUAL_STRING_LEN("left_", other, 5);
            TEST_ASSERT_EQUAL_STRING(name + 6, other + 5);
        } else if (strncmp(name, "left_", 5) != 0) {
            TEST_ASSERT_EQUAL_STRING(name, other);
        }
    }
}

/* A tree that hangs from the neck base, parents first: what a program that draws it relies on. */
static void bones_form_a_tree_from_the_neck_base(void)
{
    int reached[EDML_JOINTS] = {0};
    reached[EDML_NECK_BASE] = 1;
    for (int n = 0; n < EDML_BONES; n++) {
        TEST_ASSERT_TRUE(reached[edml_bones[n].from]);
        TEST_ASSERT_FALSE(reached[edml_bones[n].to]);
        reached[edml_bones[n].to] = 1;
    }
    for (int j = 0; j < EDML_JOINTS; j++) TEST_ASSERT_TRUE(reached[j]);
}

static void the_mirror_image_of_a_bone_is_a_bone(void)
{
    for (int n = 0; n < EDML_BONES; n++) {
        int found = 0;
        for (int m = 0; m < EDML_BONES; m++)
            found += edml_bones[m].from == edml_mirror_joint[edml_bones[n].from] &&
                     edml_bones[m].to == edml_mirror_joint[edml_bones[n].to];
        TEST_ASSERT_EQUAL_INT(1, found);
    }
}

static void every_status_has_its_name(void)
{
    TEST_ASSERT_EQUAL_STRING("ok", edml_status_name(EDML_OK));
    TEST_ASSERT_EQUAL_STRING("argument", edml_status_name(EDML_ERR_ARGUMENT));
    TEST_ASSERT_EQUAL_STRING("not_finite", edml_status_name(EDML_ERR_NOT_FINITE));
    TEST_ASSERT_EQUAL_STRING("too_few_joints", edml_status_name(EDML_ERR_TOO_FEW_JOINTS));
    TEST_ASSERT_EQUAL_STRING("degenerate", edml_status_name(EDML_ERR_DEGENERATE));
    TEST_ASSERT_EQUAL_STRING("model", edml_status_name(EDML_ERR_MODEL));
    TEST_ASSERT_EQUAL_STRING("camera", edml_status_name(EDML_ERR_CAMERA));
    TEST_ASSERT_EQUAL_STRING("time", edml_status_name(EDML_ERR_TIME));
    TEST_ASSERT_EQUAL_STRING("body", edml_status_name(EDML_ERR_BODY));
    TEST_ASSERT_EQUAL_STRING("work_too_small", edml_status_name(EDML_ERR_WORK_TOO_SMALL));
}

static void only_success_is_zero_and_errors_are_negative(void)
{
#define CHECK(name, value, text) TEST_ASSERT_TRUE((name == EDML_OK) == (value == 0) && value <= 0);
    EDML_STATUSES(CHECK)
#undef CHECK
}

static void an_unknown_status_has_the_name_of_none(void)
{
    TEST_ASSERT_EQUAL_STRING("?", edml_status_name((edml_status)-100));
    TEST_ASSERT_EQUAL_STRING("?", edml_status_name((edml_status)1));
}

static void pairs_are_counted_row_by_row_above_the_diagonal(void)
{
    int n = 0;
    for (int i = 0; i < EDML_JOINTS; i++)
        for (int j = i + 1; j < EDML_JOINTS; j++) TEST_ASSERT_EQUAL_INT(n++, EDML_PAIR(i, j));
    TEST_ASSERT_EQUAL_INT(EDML_PAIRS, n);
}

static void the_version_is_the_same_as_a_number_and_as_text(void)
{
    char text[16];
    snprintf(text, sizeof text, "%d.%d.%d", EDML_VERSION >> 16, EDML_VERSION >> 8 & 0xFF,
             EDML_VERSION & 0xFF);
    TEST_ASSERT_EQUAL_STRING(EDML_VERSION_STRING, text);
}

static void work_memory_is_what_the_header_says(void)
{
    TEST_ASSERT_TRUE(sizeof(edml_work) <= 4300); /* 4.2 KB */
    TEST_ASSERT_TRUE(sizeof(edml_work_q) <= 4300);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(each_joint_has_its_own_name);
    RUN_TEST(names_follow_the_order_of_the_enumeration);
    RUN_TEST(joints_that_do_not_exist_have_the_name_of_none);
    RUN_TEST(mirroring_twice_changes_nothing);
    RUN_TEST(mirroring_swaps_right_and_left_in_the_name);
    RUN_TEST(bones_form_a_tree_from_the_neck_base);
    RUN_TEST(the_mirror_image_of_a_bone_is_a_bone);
    RUN_TEST(every_status_has_its_name);
    RUN_TEST(only_success_is_zero_and_errors_are_negative);
    RUN_TEST(an_unknown_status_has_the_name_of_none);
    RUN_TEST(pairs_are_counted_row_by_row_above_the_diagonal);
    RUN_TEST(the_version_is_the_same_as_a_number_and_as_text);
    RUN_TEST(work_memory_is_what_the_header_says);
    return UNITY_END();
}
