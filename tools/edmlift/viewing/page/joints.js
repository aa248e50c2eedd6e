/* The 14 joints, in the order of the library, and how they are said. */

export const JOINT_COUNT = 14;
export const MIDDLE = 14; // midway between the hips, behind the joints
export const HIPS = [8, 11];
export const TORSO = [2, 5, 11, 8]; // shoulders and hips, round
export const HEAD = 0, NECK = 1;
export const ANKLES = [10, 13];

/** Puts the middle of the hips behind the joints of a pose [15 * 3]. */
export function addMiddle(pose) {
  for (let axis = 0; axis < 3; axis++)
    pose[3 * MIDDLE + axis] = (pose[3 * HIPS[0] + axis] + pose[3 * HIPS[1] + axis]) / 2;
}

/** y of the floor: under the lowest joint, because y is down. */
export function floorOf(pose) {
  let floor = -Infinity;
  for (let joint = 0; joint < JOINT_COUNT; joint++) floor = Math.max(floor, pose[3 * joint + 1]);
  return floor;
}

/** too_few_joints -> "too few joints". */
export function inWords(name) {
  return name.replaceAll("_", " ");
}

/** A number with so many digits, and a minus that is as wide as a plus. */
export function digits(value, count) {
  return value.toFixed(count).replace("-", "−");
}
