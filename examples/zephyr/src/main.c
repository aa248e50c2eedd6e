/* A pose on Zephyr: joints in millimetres, how long the lift took, and what is left of the stack.
 *
 * SPDX-License-Identifier: MIT
 */
#include <edmlift.h>
#include <zephyr/kernel.h>

static edml_work work; /* 1.9 KB: static, because it is large for a thread's stack */

/* Stands where your detector is: x and y in pixels, confidence.  It did not see the left wrist. */
static const edml_keypoint detected[EDML_JOINTS] = {
    {512, 254, 1}, {509, 336, 1},                /* head, neck base */
    {461, 318, 1}, {452, 387, 1}, {489, 440, 1}, /* right shoulder, elbow, wrist */
    {556, 317, 1}, {571, 389, 1}, {0, 0, 0},     /* left shoulder, elbow, wrist */
    {478, 466, 1}, {470, 561, 1}, {463, 655, 1}, /* right hip, knee, ankle */
    {537, 465, 1}, {551, 556, 1}, {590, 640, 1}, /* left hip, knee, ankle */
};

/* To the nearest. */
static int millimetres(float metres) { return (int)(1000.0F * metres + (metres < 0.0F ? -0.5F : 0.5F)); }

static void print_pose(const edml_pose *pose)
{
    for (int j = 0; j < EDML_JOINTS; j++)
        printk("%-14s %5d %5d %5d\n", edml_joint_name(j), millimetres(pose->joint[j].x),
               millimetres(pose->joint[j].y), millimetres(pose->joint[j].z));
}

int main(void)
{
    edml_pose pose;
    size_t unused = 0;
    const uint32_t start = k_cycle_get_32();
    const edml_status status = edml_lift(&pose, detected, NULL, &edml_direct_w16, &work, sizeof work);
    const int microseconds = (int)k_cyc_to_us_floor32(k_cycle_get_32() - start);
    if (status == EDML_OK)
        print_pose(&pose);
    else
        printk("no pose: %s\n", edml_status_name(status));
    k_thread_stack_space_get(k_current_get(), &unused);
    printk("%d.%03d ms, %d bytes of stack never used\n", microseconds / 1000, microseconds % 1000,
           (int)unused);
    return 0;
}
