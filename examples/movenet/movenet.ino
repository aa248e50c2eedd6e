/* From MoveNet to a 3D pose: its 17 keypoints of y, x, score in, a pose a line on Serial out.
 *
 * For boards with a 32-bit processor: Nano 33 BLE, ESP32, Raspberry Pi Pico, Teensy and others.  Upload it and open
 * the Serial Monitor at 115200 baud.  Until your detector is in detect(), it lifts a recorded person.
 *
 * SPDX-License-Identifier: MIT
 */
#include <Arduino.h>
#include <edmlift.h>

const float SIDE = 192;       // pixels of the detector's square input; a lift takes any scale
const float THRESHOLD = 0.1F; // a keypoint with a score up to this one was not seen

static edml_work work; // 1.9 KB: static, because a board's stack may be small
static edml_pose pose; // 14 joints in metres: x right, y down, z away from the camera; 0, 0, 0 is between the hips

// What MoveNet gave for a person whose left wrist it did not see: y, x, score; shares of its square input.
static const float recorded[17][3] = {
    {0.265F, 0.516F, 0.8F}, // nose
    {0.250F, 0.527F, 0.7F}, // left eye
    {0.250F, 0.505F, 0.8F}, // right eye
    {0.254F, 0.538F, 0.6F}, // left ear
    {0.254F, 0.486F, 0.7F}, // right ear
    {0.317F, 0.556F, 0.9F}, // left shoulder
    {0.318F, 0.461F, 0.9F}, // right shoulder
    {0.389F, 0.571F, 0.8F}, // left elbow
    {0.387F, 0.452F, 0.9F}, // right elbow
    {0.445F, 0.560F, 0.1F}, // left wrist
    {0.440F, 0.489F, 0.8F}, // right wrist
    {0.465F, 0.537F, 0.9F}, // left hip
    {0.466F, 0.478F, 0.9F}, // right hip
    {0.556F, 0.551F, 0.8F}, // left knee
    {0.561F, 0.470F, 0.9F}, // right knee
    {0.640F, 0.590F, 0.8F}, // left ankle
    {0.655F, 0.463F, 0.8F}, // right ankle
};

// YOUR DETECTOR GOES HERE.  With TensorFlow Lite Micro, after the camera's image is in interpreter->input(0):
//
//     if (interpreter->Invoke() != kTfLiteOk) return false;
//     memcpy(tensor, interpreter->output(0)->data.f, 17 * 3 * sizeof(float));
//     return true;
//
// If the output has 8 bits: tensor[k][n] = (q[3 * k + n] - zero_point) * scale.
static bool detect(float tensor[17][3])
{
    memcpy(tensor, recorded, sizeof recorded);
    return true;
}

// The tensor as the library takes keypoints: x before y, in pixels, confidence 0 where nothing was seen.
// Another detector gives other keypoints; its format goes to edml_adapt() below, such as edml_coco17 for YOLO-pose or
// edml_blazepose33.
static void read_movenet(edml_keypoint seen[17], const float tensor[17][3])
{
    for (int k = 0; k < 17; k++) {
        seen[k].x = tensor[k][1] * SIDE;
        seen[k].y = tensor[k][0] * SIDE;
        seen[k].c = tensor[k][2] > THRESHOLD ? tensor[k][2] : 0;
    }
}

static void print_number(float metres)
{
    Serial.print(',');
    Serial.print(metres, 3);
}

static void print_heading()
{
    Serial.print("status");
    for (int j = 0; j < EDML_JOINTS; j++) {
        Serial.print(",x");
        Serial.print(j);
        Serial.print(",y");
        Serial.print(j);
        Serial.print(",z");
        Serial.print(j);
    }
    Serial.println(",misfit,ms");
}

// A line: status, 14 times x, y, z, the misfit, and how long the lift took.  Without a pose these are empty.
static void print_pose(edml_status status, unsigned long us)
{
    Serial.print(edml_status_name(status));
    if (status == EDML_OK) {
        for (int j = 0; j < EDML_JOINTS; j++) {
            print_number(pose.joint[j].x);
            print_number(pose.joint[j].y);
            print_number(pose.joint[j].z);
        }
        print_number(pose.misfit);
    } else {
        for (int n = 0; n < 3 * EDML_JOINTS + 1; n++) Serial.print(',');
    }
    Serial.print(',');
    Serial.println(us / 1000.0F, 2);
}

void setup()
{
    Serial.begin(115200);
    while (!Serial && millis() < 5000) { // until the Serial Monitor is open, for boards with USB of their own
    }
    if (edml_model_check(&edml_direct_w16) != EDML_OK) Serial.println("# the model in flash is damaged");
    print_heading();
}

void loop()
{
    float tensor[17][3];
    if (!detect(tensor)) return;

    edml_keypoint seen[17], joints[EDML_JOINTS];
    const unsigned long start = micros();
    read_movenet(seen, tensor);
    edml_adapt(joints, seen, &edml_movenet17);
    const edml_status status = edml_lift(&pose, joints, NULL, &edml_direct_w16, &work, sizeof work);
    print_pose(status, micros() - start);
    delay(500); // not needed with a detector, which takes longer than the lift
}
