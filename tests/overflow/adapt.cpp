/* SPDX-License-Identifier: MIT */
#include "api_checked.h"

#include "joints/adapt.h"

extern "C" void checked_adapt(edml_keypoint_q out[EDML_JOINTS], const edml_keypoint_q in[],
                              const edml_format *format, checked_tally *taken)
{
    const checked_keypoints seen(in, format->keypoints);
    edml_keypoint_checked joint[EDML_JOINTS];
    tally = checked_tally();
    edml_adapt_checked(joint, seen.joint, format);
    *taken = tally;
    for (int j = 0; j < EDML_JOINTS; j++) {
        out[j].x = joint[j].x.value();
        out[j].y = joint[j].y.value();
        out[j].c = joint[j].c;
    }
}
