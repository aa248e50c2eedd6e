/* Names of keypoints, and of the formats that have so many.
 *
 * SPDX-License-Identifier: MIT
 */
#include <ctype.h>
#include <stdio.h>
#include <string.h>

#include "keypoints.h"

/* tfjs-models pose-detection */
static const char *const coco[] = {
    "nose",           "left_eye",   "right_eye",   "left_ear",   "right_ear",   "left_shoulder",
    "right_shoulder", "left_elbow", "right_elbow", "left_wrist", "right_wrist", "left_hip",
    "right_hip",      "left_knee",  "right_knee",  "left_ankle", "right_ankle",
};
static const char *const blazepose[] = {
    "nose",        "left_eye_inner",  "left_eye",         "left_eye_outer", "right_eye_inner",
    "right_eye",   "right_eye_outer", "left_ear",         "right_ear",      "mouth_left",
    "mouth_right", "left_shoulder",   "right_shoulder",   "left_elbow",     "right_elbow",
    "left_wrist",  "right_wrist",     "left_pinky",       "right_pinky",    "left_index",
    "right_index", "left_thumb",      "right_thumb",      "left_hip",       "right_hip",
    "left_knee",   "right_knee",      "left_ankle",       "right_ankle",    "left_heel",
    "right_heel",  "left_foot_index", "right_foot_index",
};

const char *name_of_keypoint(int index, const options *set)
{
    if (set->format == NULL) return edml_joint_name(index);
    if (set->format == &edml_coco17 || set->format == &edml_movenet17) return coco[index];
    return set->format == &edml_blazepose33 ? blazepose[index] : NULL;
}

static int is_same(const char *name, const char *text, size_t length)
{
    for (size_t n = 0; n < length; n++)
        if (name[n] == '\0' || tolower((unsigned char)text[n]) != name[n]) return 0;
    return name[length] == '\0';
}

int keypoint_named(const char *text, size_t length, const options *set)
{
    for (int n = 0; n < keypoints_of(set); n++) {
        const char *name = name_of_keypoint(n, set);
        if (name != NULL && is_same(name, text, length)) return n;
    }
    return -1;
}

const char *formats_with(int count, int are_numbers)
{
    static char text[256];
    int length = 0;
    text[0] = '\0';
    for (int n = 0; edml_formats[n] != NULL; n++) {
        const int keypoints = edml_formats[n]->keypoints;
        if (are_numbers ? count != 2 * keypoints && count != 3 * keypoints : count != keypoints) continue;
        if (length == 0) length = snprintf(text, sizeof text, "; formats with %d:", count);
        length += snprintf(text + length, sizeof text - (size_t)length, " %s,", edml_formats[n]->name);
    }
    if (length > 0) snprintf(text + length - 1, sizeof text - (size_t)length, ": name one by --format");
    return text;
}
