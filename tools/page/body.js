/* The body that is drawn: names of the joints, their sides, and the bones as `edmlift draw` has them. */

import { BONES, JOINTS } from "./lift/index.js";
import { HIPS, MIDDLE, NECK, TORSO, inWords } from "./view/joints.js";

const [RIGHT_SHOULDER, LEFT_SHOULDER] = TORSO;

const sideOf = (name) => /^(right|left)(?=_)/.exec(name)?.[0] ?? "trunk";
const jointSides = JOINTS.map(sideOf);
const onTrunk = (joint) => joint === RIGHT_SHOULDER || joint === LEFT_SHOULDER;

/* The skeleton's bones, but a spine and a pelvis for the two long ones from the neck to the hips. */
const bones = [
  ...BONES.filter(([, end]) => !HIPS.includes(end)).map(([start, end]) => [
    start, end, onTrunk(end) ? "trunk" : jointSides[end],
  ]),
  [NECK, MIDDLE, "trunk"],
  ...HIPS.map((hip) => [MIDDLE, hip, "trunk"]),
];

export const BODY = { names: JOINTS.map(inWords), jointSides, bones };
