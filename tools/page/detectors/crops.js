/* The square of a frame that MoveNet is shown: where the person was in the frame before.
 *
 * The rule is that of Google's own programs for MoveNet (the tutorial of TensorFlow Hub, those for TensorFlow Lite and
 * TensorFlow.js), as in tools/data/crops.py. */

const SEEN = 0.2; // least score of a keypoint that counts
const TRUNK_ROOM = 1.9, BODY_ROOM = 1.2; // half a side, in distances of keypoints from the mid-hip
const SHOULDERS = [5, 6], HIPS = [11, 12];

/** All of a frame, padded on two sides: { left, top, side } in its pixels. */
export function whole(width, height) {
  const side = Math.max(width, height);
  return { left: (width - side) / 2, top: (height - side) / 2, side };
}

/** The square for the next frame, of keypoints [x, y, score] in pixels of this one. */
export function around(keypoints, width, height) {
  const isSeen = (joint) => keypoints[joint][2] > SEEN;
  if (!HIPS.some(isSeen) || !SHOULDERS.some(isSeen)) return whole(width, height);
  const centre = [0, 1].map((axis) => (keypoints[HIPS[0]][axis] + keypoints[HIPS[1]][axis]) / 2);
  const reach = keypoints.map(([x, y]) => Math.max(Math.abs(x - centre[0]), Math.abs(y - centre[1])));
  const trunk = Math.max(...[...SHOULDERS, ...HIPS].map((joint) => reach[joint]));
  const body = Math.max(...reach.filter((_, joint) => keypoints[joint][2] >= SEEN));
  const toEdge = Math.max(...centre, width - centre[0], height - centre[1]);
  const half = Math.min(Math.max(TRUNK_ROOM * trunk, BODY_ROOM * body), toEdge);
  if (2 * half > Math.max(width, height)) return whole(width, height);
  return { left: centre[0] - half, top: centre[1] - half, side: 2 * half };
}
