/* Without an FPU: the program of the README in integers, without a float instruction, and with the network
 * that takes fewest of them. */
#include <stdio.h>

#include "edmlift/fixed.h"

#define PIXELS(n) ((int32_t)(n) * 65536) /* Q16 */
enum { SEEN = 32767, NOT_SEEN = 0 };     /* confidences: 32767 is 1 */

static edml_work_q work; /* 1.9 KB */

static int to_millimetres(int32_t metres) { return (int)(metres * 125 / 8192); } /* from Q16 */

int main(void)
{
    static const edml_keypoint_q in[EDML_JOINTS] = {
        {PIXELS(512), PIXELS(254), SEEN}, /* head */
        {PIXELS(509), PIXELS(336), SEEN}, /* neck base */
        {PIXELS(461), PIXELS(318), SEEN}, /* right shoulder */
        {PIXELS(452), PIXELS(387), SEEN}, /* right elbow */
        {PIXELS(489), PIXELS(440), SEEN}, /* right wrist */
        {PIXELS(556), PIXELS(317), SEEN}, /* left shoulder */
        {PIXELS(571), PIXELS(389), SEEN}, /* left elbow */
        {PIXELS(0), PIXELS(0), NOT_SEEN}, /* left wrist */
        {PIXELS(478), PIXELS(466), SEEN}, /* right hip */
        {PIXELS(470), PIXELS(561), SEEN}, /* right knee */
        {PIXELS(463), PIXELS(655), SEEN}, /* right ankle */
        {PIXELS(537), PIXELS(465), SEEN}, /* left hip */
        {PIXELS(551), PIXELS(556), SEEN}, /* left knee */
        {PIXELS(590), PIXELS(640), SEEN}, /* left ankle */
    };
    edml_pose_q pose;
    edml_status status = edml_lift_q(&pose, in, NULL, &edml_direct_w16, &work, sizeof work);
    if (status != EDML_OK) {
        printf("no pose: %s\n", edml_status_name(status));
        return 1;
    }
    for (int j = 0; j < EDML_JOINTS; j++) /* millimetres */
        printf("%-14s %5d %5d %5d\n", edml_joint_name(j), to_millimetres(pose.joint[j].x),
               to_millimetres(pose.joint[j].y), to_millimetres(pose.joint[j].z));
    return 0;
}
