// A detector's keypoints in, a pose in metres out: npm install edmlift, node lift.mjs
import { JOINTS, load } from "edmlift";

// One person in a picture of 480 x 480 pixels, as MoveNet of TensorFlow.js gives it.
const keypoints = [
  { x: 250, y: 170, score: 0.9, name: "nose" },
  { x: 257, y: 160, score: 0.8, name: "left_eye" },
  { x: 243, y: 160, score: 0.9, name: "right_eye" },
  { x: 264, y: 163, score: 0.7, name: "left_ear" },
  { x: 231, y: 163, score: 0.8, name: "right_ear" },
  { x: 276, y: 203, score: 0.9, name: "left_shoulder" },
  { x: 215, y: 204, score: 0.9, name: "right_shoulder" },
  { x: 285, y: 249, score: 0.8, name: "left_elbow" },
  { x: 209, y: 248, score: 0.9, name: "right_elbow" },
  { x: 278, y: 285, score: 0.05, name: "left_wrist" }, // a guess, as its score says
  { x: 233, y: 282, score: 0.8, name: "right_wrist" },
  { x: 264, y: 298, score: 0.9, name: "left_hip" },
  { x: 226, y: 298, score: 0.9, name: "right_hip" },
  { x: 273, y: 356, score: 0.8, name: "left_knee" },
  { x: 221, y: 359, score: 0.9, name: "right_knee" },
  { x: 298, y: 410, score: 0.8, name: "left_ankle" },
  { x: 222, y: 419, score: 0.8, name: "right_ankle" },
];

const lifter = await load();
const pose = lifter.lift(keypoints, { format: "coco17", width: 480, height: 480 });
if (pose.status !== "ok") throw new Error(`no pose: ${pose.status}`);
for (const [j, name] of JOINTS.entries()) {
  const place = Array.from(pose.joints.subarray(3 * j, 3 * j + 3), (metres) => metres.toFixed(3).padStart(7));
  console.log(name.padEnd(15), pose.seen[j] ? "seen   " : "imputed", ...place);
}
console.log(`quality ${pose.quality.toFixed(2)}, right knee ${lifter.angles(pose).right_knee_flexion.toFixed(0)} degrees`);
