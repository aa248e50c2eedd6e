/* joints/adapt.h and formats.c: detectors' own names of their keypoints, and where head and neck go.
 *
 * SPDX-License-Identifier: MIT
 */
#include "as_float.h"

enum { MOST = 33 };

#ifndef EDML_TEST_Q24
#define BEYOND INFINITY /* the least coordinate that is not finite */
#else
#define BEYOND 8192.0F
#endif

/* ---- The detectors' lists, in the words of edml_joint_name() ------------------------------------- */

#define COCO                                                                                               \
    "nose", "left_eye", "right_eye", "left_ear", "right_ear", "left_shoulder", "right_shoulder",           \
        "left_elbow", "right_elbow", "left_wrist", "right_wrist", "left_hip", "right_hip", "left_knee",    \
        "right_knee", "left_ankle", "right_ankle"
#define OPENPOSE_ARMS                                                                                      \
    "nose", "openpose_neck", "right_shoulder", "right_elbow", "right_wrist", "left_shoulder",              \
        "left_elbow", "left_wrist"
#define LEGS "right_hip", "right_knee", "right_ankle", "left_hip", "left_knee", "left_ankle"
#define OPENPOSE_FACE "right_eye", "left_eye", "right_ear", "left_ear"
#define CPM                                                                                                \
    "crown", "upper_neck", "right_shoulder", "right_elbow", "right_wrist", "left_shoulder", "left_elbow",  \
        "left_wrist", LEGS
#define H36M_ABOVE                                                                                         \
    "spine", "thorax", "neck_base", "centre", "left_shoulder", "left_elbow", "left_wrist",                 \
        "right_shoulder", "right_elbow", "right_wrist"

static const struct {
    const edml_format *format;
    const char *keypoint[MOST];
} lists[] = {
    /* mmpose coco.py; tfjs-models pose-detection */
    {&edml_coco17, {COCO}},
    /* google-research movenet; tfhub movenet/singlepose */
    {&edml_movenet17, {COCO}},
    /* openpose poseParameters.cpp */
    {&edml_body25,
     {OPENPOSE_ARMS, "mid_hip", LEGS, OPENPOSE_FACE, "left_big_toe", "left_small_toe", "left_heel",
      "right_big_toe", "right_small_toe", "right_heel"}},
    {&edml_coco18, {OPENPOSE_ARMS, LEGS, OPENPOSE_FACE}},
    {&edml_mpi15, {CPM, "chest"}},
    {&edml_body25b,
     {COCO, "upper_neck", "crown", "left_big_toe", "left_small_toe", "left_heel", "right_big_toe",
      "right_small_toe", "right_heel"}},
    /* CPM testing/config.m */
    {&edml_cpm14, {CPM}},
    /* mmpose mpii.py */
    {&edml_mpii16,
     {"right_ankle", "right_knee", "right_hip", "left_hip", "left_knee", "left_ankle", "pelvis", "thorax",
      "upper_neck", "crown", "right_wrist", "right_elbow", "right_shoulder", "left_shoulder", "left_elbow",
      "left_wrist"}},
    /* CPM training/genJSON.m; mmhuman3d lsp.py */
    {&edml_lsp14,
     {"right_ankle", "right_knee", "right_hip", "left_hip", "left_knee", "left_ankle", "right_wrist",
      "right_elbow", "right_shoulder", "left_shoulder", "left_elbow", "left_wrist", "upper_neck", "crown"}},
    /* mmpose h36m.py; mmhuman3d H36M_KEYPOINTS */
    {&edml_h36m17_right_first, {"root", LEGS, H36M_ABOVE}},
    {&edml_h36m17_left_first,
     {"root", "left_hip", "left_knee", "left_ankle", "right_hip", "right_knee", "right_ankle", H36M_ABOVE}},
    /* mediapipe pose_landmarker.py; the middle of an eye is called the eye */
    {&edml_blazepose33,
     {"nose",        "left_eye_inner",  "left_eye",        "left_eye_outer", "right_eye_inner",
      "right_eye",   "right_eye_outer", "left_ear",        "right_ear",      "mouth_left",
      "mouth_right", "left_shoulder",   "right_shoulder",  "left_elbow",     "right_elbow",
      "left_wrist",  "right_wrist",     "left_pinky",      "right_pinky",    "left_index",
      "right_index", "left_thumb",      "right_thumb",     "left_hip",       "right_hip",
      "left_knee",   "right_knee",      "left_ankle",      "right_ankle",    "left_heel",
      "right_heel",  "left_foot_index", "right_foot_index"}},
    /* mmpose halpe26.py */
    {&edml_halpe26,
     {COCO, "crown", "throat", "hip", "left_big_toe", "right_big_toe", "left_small_toe", "right_small_toe",
      "left_heel", "right_heel"}},
    /* mmpose crowdpose.py */
    {&edml_crowdpose14,
     {"left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist",
      "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle", "right_ankle", "crown",
      "neck_base"}},
    /* mmpose aic.py */
    {&edml_aic14,
     {"right_shoulder", "right_elbow", "right_wrist", "left_shoulder", "left_elbow", "left_wrist", LEGS,
      "crown", "neck_base"}},
};
enum { LISTS = (int)(sizeof lists / sizeof lists[0]) };

static int has(int list, const char *name)
{
    for (int n = 0; n < lists[list].format->keypoints; n++)
        if (strcmp(lists[list].keypoint[n], name) == 0) return 1;
    return 0;
}

static void check_name(int list, const char *name, int index)
{
    if (!has(list, name))
        TEST_ASSERT_EQUAL_INT_MESSAGE(EDML_NO_KEYPOINT, index, lists[list].format->name);
    else
        TEST_ASSERT_EQUAL_STRING_MESSAGE(name, lists[list].keypoint[index], lists[list].format->name);
}

static void every_index_is_the_keypoint_of_that_name(void)
{
    for (int n = 0; n < LISTS; n++) {
        const edml_format *format = lists[n].format;
        for (int j = EDML_R_SHOULDER; j < EDML_JOINTS; j++)
            check_name(n, edml_joint_name(j), format->limb[j - EDML_R_SHOULDER]);
        check_name(n, "left_ear", format->ears[0]);
        check_name(n, "right_ear", format->ears[1]);
        check_name(n, "left_eye", format->face[0]);
        check_name(n, "right_eye", format->face[1]);
        check_name(n, "nose", format->face[2]);
        check_name(n, "crown", format->crown);
        check_name(n, "centre", format->centre);
    }
}

static void the_number_of_keypoints_is_that_of_the_list(void)
{
    for (int n = 0; n < LISTS; n++) {
        int count = 0;
        while (count < MOST && lists[n].keypoint[count] != NULL) count++;
        TEST_ASSERT_EQUAL_INT_MESSAGE(count, lists[n].format->keypoints, lists[n].format->name);
    }
}

static void every_format_is_found_by_its_name_and_no_other(void)
{
    TEST_ASSERT_NULL(edml_formats[LISTS]); /* the end */
    for (int n = 0; n < LISTS; n++) {
        TEST_ASSERT_NOT_NULL(edml_formats[n]);
        TEST_ASSERT_TRUE(edml_format_find(edml_formats[n]->name) == edml_formats[n]);
        TEST_ASSERT_TRUE(edml_format_find(lists[n].format->name) == lists[n].format);
    }
    TEST_ASSERT_NULL(edml_format_find(""));
    TEST_ASSERT_NULL(edml_format_find("coco"));
    TEST_ASSERT_NULL(edml_format_find("coco177"));
}

static void blazepose_is_normalised_by_the_image_and_movenet_by_a_square(void)
{
    for (int n = 0; edml_formats[n] != NULL; n++) {
        const edml_format *format = edml_formats[n];
        const int expected = format == &edml_blazepose33 ? EDML_BY_IMAGE
                             : format == &edml_movenet17 ? EDML_BY_SQUARE
                                                         : EDML_NOT_NORMALISED;
        TEST_ASSERT_EQUAL_INT(expected, format->normalised);
    }
}

/* ---- A figure in a T ----------------------------------------------------------------------------- */

static const struct {
    const char *name;
    float x, y;
} figure[] = {
    /* faces the camera: the subject's right is at the left */
    {"crown", 500, 140},       {"centre", 500, 200},         {"nose", 500, 215},
    {"left_eye", 510, 185},    {"right_eye", 490, 185},      {"left_ear", 530, 200},
    {"right_ear", 470, 200},   {"right_shoulder", 430, 300}, {"right_elbow", 330, 302},
    {"right_wrist", 230, 304}, {"left_shoulder", 570, 300},  {"left_elbow", 670, 302},
    {"left_wrist", 770, 304},  {"right_hip", 455, 500},      {"right_knee", 450, 650},
    {"right_ankle", 445, 800}, {"left_hip", 545, 500},       {"left_knee", 550, 650},
    {"left_ankle", 555, 800},
};
enum { POINTS = (int)(sizeof figure / sizeof figure[0]) };

static edml_keypoint in[MOST], out[EDML_JOINTS], again[EDML_JOINTS];

/* What the detector of a list sees; keypoints that the figure lacks are far away, to be noticed. */
static void detect(int list)
{
    for (int n = 0; n < MOST; n++) {
        in[n].x = in[n].y = 5000;
        in[n].c = 0.75F;
        for (int p = 0; p < POINTS && lists[list].keypoint[n] != NULL; p++) {
            if (strcmp(figure[p].name, lists[list].keypoint[n]) != 0) continue;
            in[n].x = figure[p].x;
            in[n].y = figure[p].y;
        }
    }
}

static edml_keypoint *point(int list, const char *name)
{
    for (int n = 0; n < lists[list].format->keypoints; n++)
        if (strcmp(lists[list].keypoint[n], name) == 0) return &in[n];
    return NULL;
}

static void hide(int list, const char *name)
{
    edml_keypoint *hidden = point(list, name);
    if (hidden == NULL) return;
    hidden->c = 0;
    hidden->x = NAN; /* must not matter */
}

static void hide_face(int list)
{
    static const char *const names[] = {"left_ear", "right_ear", "left_eye", "right_eye", "nose"};
    for (unsigned n = 0; n < sizeof names / sizeof *names; n++) hide(list, names[n]);
}

static void adapt(int list) { edml_adapt(out, in, lists[list].format); }

static void check_at(float x, float y, float c, edml_keypoint found)
{
    TEST_ASSERT_FLOAT_WITHIN(1e-3F, x, found.x);
    TEST_ASSERT_FLOAT_WITHIN(1e-3F, y, found.y);
    TEST_ASSERT_FLOAT_WITHIN(1e-4F, c, found.c);
}

static void check_not_seen(edml_keypoint found)
{
    TEST_ASSERT_TRUE(found.c == 0 && found.x == 0 && found.y == 0);
}

static void limbs_are_copied_bit_for_bit(void)
{
    for (int n = 0; n < LISTS; n++) {
        detect(n);
        adapt(n);
        for (int j = EDML_R_SHOULDER; j < EDML_JOINTS; j++)
            TEST_ASSERT_SAME_BYTES(*point(n, edml_joint_name(j)), out[j]);
    }
}

static void the_neck_is_12_percent_down_the_trunk(void)
{
    for (int n = 0; n < LISTS; n++) {
        detect(n);
        adapt(n);
        check_at(500, 324, 0.375F, out[EDML_NECK_BASE]);
    }
}

static void without_a_hip_the_neck_is_between_the_shoulders(void)
{
    for (int n = 0; n < LISTS; n++) {
        detect(n);
        hide(n, "left_hip");
        adapt(n);
        check_at(500, 300, 0.375F, out[EDML_NECK_BASE]);
    }
}

/* From (500, 300): both ears, else the crown or the centre. */
static void the_head_is_where_its_best_evidence_says(void)
{
    for (int n = 0; n < LISTS; n++) {
        detect(n);
        adapt(n);
        const float y = has(n, "left_ear") ? 200.0F : has(n, "crown") ? 300 - 0.64F * 160 : 198.0F;
        check_at(500, y, 0.375F, out[EDML_HEAD]);
    }
}

static void a_profile_has_its_head_at_one_ear(void)
{
    for (int n = 0; n < LISTS; n++) {
        if (!has(n, "left_ear") || has(n, "crown")) continue;
        detect(n);
        hide(n, "right_ear");
        hide(n, "right_eye");
        adapt(n);
        check_at(500 + 0.97F * 30, 300 - 0.97F * 100, 0.375F, out[EDML_HEAD]);
    }
}

static void without_ears_the_head_is_at_eyes_and_nose(void)
{
    for (int n = 0; n < LISTS; n++) {
        if (!has(n, "left_ear") || has(n, "crown")) continue;
        detect(n);
        hide(n, "left_ear");
        hide(n, "right_ear");
        adapt(n);
        check_at(500, 300 - 0.95F * 105, 0.375F, out[EDML_HEAD]);
        hide(n, "left_eye");
        hide(n, "nose");
        adapt(n);
        check_at(500 - 0.95F * 10, 300 - 0.95F * 115, 0.375F, out[EDML_HEAD]);
    }
}

static void with_a_crown_a_single_ear_is_not_asked(void)
{
    for (int n = 0; n < LISTS; n++) {
        if (!has(n, "crown")) continue;
        detect(n);
        hide(n, "left_ear");
        adapt(n);
        check_at(500, 300 - 0.64F * 160, 0.375F, out[EDML_HEAD]);
    }
}

static void a_head_that_was_not_seen_at_all_is_not_seen(void)
{
    for (int n = 0; n < LISTS; n++) {
        detect(n);
        hide_face(n);
        hide(n, "crown");
        hide(n, "centre");
        adapt(n);
        check_not_seen(out[EDML_HEAD]);
        check_at(500, 324, 0.375F, out[EDML_NECK_BASE]);
    }
}

static void without_a_shoulder_there_is_neither_head_nor_neck(void)
{
    for (int n = 0; n < LISTS; n++) {
        detect(n);
        hide(n, "right_shoulder");
        adapt(n);
        check_not_seen(out[EDML_HEAD]);
        check_not_seen(out[EDML_NECK_BASE]);
    }
}

static void nobody_gives_no_joint(void)
{
    for (int n = 0; n < LISTS; n++) {
        memset(in, 0, sizeof in);
        adapt(n);
        for (int j = 0; j < EDML_JOINTS; j++) check_not_seen(out[j]);
    }
}

/* ---- Confidence ---------------------------------------------------------------------------------- */

static void a_guess_has_half_the_least_confidence_of_its_sources(void)
{
    for (int n = 0; n < LISTS; n++) {
        detect(n);
        point(n, "left_shoulder")->c = 0.5F;
        point(n, "right_hip")->c = 0.25F;
        adapt(n);
        TEST_ASSERT_FLOAT_WITHIN(1e-4F, 0.25F, out[EDML_HEAD].c);
        TEST_ASSERT_FLOAT_WITHIN(1e-4F, 0.125F, out[EDML_NECK_BASE].c);
        if (has(n, "left_ear")) point(n, "left_ear")->c = 0.125F;
        if (has(n, "crown")) point(n, "crown")->c = 0.125F;
        if (has(n, "centre")) point(n, "centre")->c = 0.125F;
        adapt(n);
        TEST_ASSERT_FLOAT_WITHIN(1e-4F, 0.0625F, out[EDML_HEAD].c);
    }
}

static void the_least_confidence_that_is_seen_stays_seen(void)
{
    const float least = 1.0F / 32768;
    for (int n = 0; n < LISTS; n++) {
        detect(n);
        for (int k = 0; k < MOST; k++) in[k].c = least;
        adapt(n);
        TEST_ASSERT_TRUE(out[EDML_HEAD].c > 0 && out[EDML_NECK_BASE].c > 0);
    }
}

/* The lift refuses it. */
static void check_broken(edml_keypoint joint)
{
    TEST_ASSERT_TRUE(joint.c > 0);
    TEST_ASSERT_FALSE(fabsf(joint.x) < BEYOND && fabsf(joint.y) < BEYOND);
}

static edml_status lift(void)
{
    static edml_work work;
    edml_pose pose;
    return edml_lift(&pose, out, NULL, &edml_direct_f32, &work, sizeof work);
}

static void every_format_lifts(void)
{
    for (int n = 0; n < LISTS; n++) {
        detect(n);
        adapt(n);
        TEST_ASSERT_EQUAL_INT(EDML_OK, lift());
    }
}

/* Whatever is broken in whichever keypoint that counts: the lift finds out. */
static void what_is_not_finite_comes_through(void)
{
    static const char *const heads[] = {"left_ear", "right_ear", "crown", "centre"};
    static const edml_keypoint broken[] = {
        {NAN, 1, 1}, {1, INFINITY, 1}, {-INFINITY, 1, 1},
#ifndef EDML_TEST_Q24 /* there every confidence is finite */
        {1, 1, NAN}, {1, 1, INFINITY}, {1, 1, -INFINITY},
#endif
    };
    for (int n = 0; n < LISTS; n++) {
        for (unsigned b = 0; b < sizeof broken / sizeof *broken; b++) {
            for (int j = EDML_R_SHOULDER; j < EDML_JOINTS; j++) {
                detect(n);
                *point(n, edml_joint_name(j)) = broken[b];
                adapt(n);
                TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, lift());
            }
            for (unsigned h = 0; h < sizeof heads / sizeof *heads; h++) {
                if (!has(n, heads[h]) || (h == 2 && has(n, heads[0]))) continue; /* ears go first */
                detect(n);
                *point(n, heads[h]) = broken[b];
                adapt(n);
                TEST_ASSERT_EQUAL_INT(EDML_ERR_NOT_FINITE, lift());
            }
        }
    }
}

/* However little a keypoint is trusted. */
static void what_is_not_finite_comes_through_with_any_confidence(void)
{
    static const float confidence[] = {1.0F / 32768, 0.5F, 1};
    for (int n = 0; n < LISTS; n++) {
        for (int k = 0; k < 3; k++) {
            detect(n);
            *point(n, "left_shoulder") = (edml_keypoint){NAN, 1, confidence[k]};
            adapt(n);
            check_broken(out[EDML_HEAD]);
            check_broken(out[EDML_NECK_BASE]);
            detect(n);
            *point(n, "right_hip") = (edml_keypoint){1, NAN, confidence[k]};
            adapt(n);
            check_broken(out[EDML_NECK_BASE]);
        }
    }
}

/* Not even if the guess that it makes is within the image again. */
static void a_shoulder_out_of_range_makes_no_sound_neck(void)
{
    for (int n = 0; n < LISTS; n++) {
        detect(n);
        *point(n, "left_shoulder") = (edml_keypoint){BEYOND, 300, 1};
        point(n, "left_hip")->x = point(n, "right_hip")->x = -8000;
        adapt(n);
        check_broken(out[EDML_HEAD]);
        check_broken(out[EDML_NECK_BASE]);
    }
}

/* ---- Left and right ------------------------------------------------------------------------------ */

/* The figure as a mirror shows it: x is negated, and left keypoints are called right. */
static void look_into_a_mirror(int list)
{
    edml_keypoint was[MOST];
    memcpy(was, in, sizeof was);
    for (int n = 0; n < lists[list].format->keypoints; n++) {
        const char *name = lists[list].keypoint[n];
        const int left = strncmp(name, "left_", 5) == 0, right = strncmp(name, "right_", 6) == 0;
        char other[32];
        strcpy(other, left ? "right_" : right ? "left_" : "");
        strcat(other, name + (left ? 5 : right ? 6 : 0));
        const edml_keypoint *to = point(list, other);
        if (to == NULL) continue;
        in[to - in] = was[n];
        in[to - in].x = -was[n].x;
    }
}

static void a_mirrored_person_gives_mirrored_joints(void)
{
    rng r = rng_seed(3);
    for (int n = 0; n < LISTS; n++) {
        for (int k = 0; k < 20; k++) {
            detect(n);
            for (int p = 0; p < MOST; p++) {
                in[p].x = floorf(uniform(&r, -900, 900));
                in[p].y = floorf(uniform(&r, 0, 900));
                in[p].c = uniform(&r, -0.2F, 1);
            }
            adapt(n);
            memcpy(again, out, sizeof again);
            look_into_a_mirror(n);
            adapt(n);
            for (int j = 0; j < EDML_JOINTS; j++)
                check_at(-again[edml_mirror_joint[j]].x, again[edml_mirror_joint[j]].y,
                         again[edml_mirror_joint[j]].c, out[j]);
        }
    }
}

/* ---- A format of one's own, and the ends of the range ------------------------------------------- */

static void a_limb_that_a_format_lacks_is_not_seen(void)
{
    edml_format waist_up = edml_coco17;
    for (int j = EDML_R_HIP; j < EDML_JOINTS; j++) waist_up.limb[j - EDML_R_SHOULDER] = EDML_NO_KEYPOINT;
    detect(0);
    edml_adapt(out, in, &waist_up);
    for (int j = EDML_R_HIP; j < EDML_JOINTS; j++) check_not_seen(out[j]);
    check_at(500, 300, 0.375F, out[EDML_NECK_BASE]);
}

#ifndef EDML_TEST_Q24 /* as_float.h passes on what a format has */
/* As if there were more behind the detector's last keypoint. */
static void keypoints_that_a_format_lacks_are_not_looked_at(void)
{
    static edml_keypoint more[256];
    edml_format bare = edml_coco17;
    bare.crown = bare.centre = bare.ears[0] = bare.face[1] = bare.limb[2] = EDML_NO_KEYPOINT;
    for (int n = 0; n < 256; n++) more[n] = (edml_keypoint){3000, 3000, 1};
    detect(0);
    memcpy(more, in, bare.keypoints * sizeof *in);
    edml_adapt(out, more, &bare);
    check_not_seen(out[EDML_R_SHOULDER + 2]);
    TEST_ASSERT_TRUE(out[EDML_HEAD].c > 0 && out[EDML_HEAD].x < 600 && out[EDML_HEAD].y < 300);
}
#endif

static int in_range(edml_keypoint_q p) { return p.x > -(1 << 29) && p.x < 1 << 29; }

/* Overflow is the sanitizer's to find; what is out of range in a keypoint is so in the joint. */
static void integers_up_to_the_ends_of_their_range(void)
{
    static const int32_t end[] = {(1 << 29) - 1, 1 - (1 << 29), INT32_MAX, INT32_MIN};
    edml_keypoint_q wide[MOST], joint[EDML_JOINTS];
    rng r = rng_seed(4);
    for (int n = 0; n < LISTS; n++) {
        for (int k = 0; k < 2000; k++) {
            for (int p = 0; p < MOST; p++) {
                wide[p].x = end[rng_bits(&r) >> 8 & (k % 2 ? 3 : 1)];
                wide[p].y = end[rng_bits(&r) >> 8 & 1];
                wide[p].c = INT16_MAX;
            }
            edml_adapt_q(joint, wide, lists[n].format);
            const int broken = !in_range(joint[EDML_R_SHOULDER]) || !in_range(joint[EDML_L_SHOULDER]) ||
                               !in_range(joint[EDML_R_HIP]) || !in_range(joint[EDML_L_HIP]);
            TEST_ASSERT_EQUAL_INT(!broken, in_range(joint[EDML_NECK_BASE]));
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(every_index_is_the_keypoint_of_that_name);
    RUN_TEST(the_number_of_keypoints_is_that_of_the_list);
    RUN_TEST(every_format_is_found_by_its_name_and_no_other);
    RUN_TEST(blazepose_is_normalised_by_the_image_and_movenet_by_a_square);
    RUN_TEST(limbs_are_copied_bit_for_bit);
    RUN_TEST(the_neck_is_12_percent_down_the_trunk);
    RUN_TEST(without_a_hip_the_neck_is_between_the_shoulders);
    RUN_TEST(the_head_is_where_its_best_evidence_says);
    RUN_TEST(a_profile_has_its_head_at_one_ear);
    RUN_TEST(without_ears_the_head_is_at_eyes_and_nose);
    RUN_TEST(with_a_crown_a_single_ear_is_not_asked);
    RUN_TEST(a_head_that_was_not_seen_at_all_is_not_seen);
    RUN_TEST(without_a_shoulder_there_is_neither_head_nor_neck);
    RUN_TEST(nobody_gives_no_joint);
    RUN_TEST(a_guess_has_half_the_least_confidence_of_its_sources);
    RUN_TEST(the_least_confidence_that_is_seen_stays_seen);
    RUN_TEST(every_format_lifts);
    RUN_TEST(what_is_not_finite_comes_through);
    RUN_TEST(what_is_not_finite_comes_through_with_any_confidence);
    RUN_TEST(a_shoulder_out_of_range_makes_no_sound_neck);
    RUN_TEST(a_mirrored_person_gives_mirrored_joints);
    RUN_TEST(a_limb_that_a_format_lacks_is_not_seen);
#ifndef EDML_TEST_Q24
    RUN_TEST(keypoints_that_a_format_lacks_are_not_looked_at);
#endif
    RUN_TEST(integers_up_to_the_ends_of_their_range);
    return UNITY_END();
}
