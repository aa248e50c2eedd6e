/* The lift: the chosen network, a track of the person in a video, and what a lift costs. */

import { load } from "./lift/index.js";

const MEASUREMENTS = 10; // of a lift's time, of which the least counts: others had to wait for something
const MEASURED_FOR = 4; // milliseconds that a measurement repeats the lift, because clocks are coarse
const NEW_SHARE = 0.05; // of a frame's time in the mean

export class Lifting {
  constructor() {
    this.lifters = new Map();
    this.lifter = null;
    this.up = undefined;
    this.track = null;
    this.milliseconds = NaN;
  }

  /** Lifts by this network from now on; an Error says why it cannot. */
  async choose(model) {
    if (!this.lifters.has(model)) this.lifters.set(model, await load({ model }));
    this.lifter = this.lifters.get(model);
    this.track = null;
    this.milliseconds = NaN;
  }

  /** Where upwards is in the camera's axes, or undefined. */
  setUp(up) {
    this.up = up;
    this.track = null;
  }

  /** The pose of 14 joints [x, y, confidence]. */
  lift(joints) {
    const lift = () => this.lifter.lift(joints, { up: this.up });
    if (Number.isNaN(this.milliseconds))
      this.milliseconds = Math.min(...Array.from({ length: MEASUREMENTS }, () => meanTime(lift)));
    return lift();
  }

  /** Starts anew: what comes is another video, or another moment of it. */
  cut() {
    this.track = null;
  }

  /** The pose of the next frame.
   *   found  { keypoints, format, width, height } of a detector
   *   time   of the frame, milliseconds */
  liftFrame({ keypoints, format, width, height }, time, mirrored) {
    this.track ??= this.lifter.track({ format, width, height, mirrored, up: this.up });
    const start = performance.now();
    const pose = this.track.lift(keypoints, time);
    const took = performance.now() - start;
    const before = Number.isNaN(this.milliseconds) ? took : this.milliseconds;
    this.milliseconds = before + NEW_SHARE * (took - before);
    return pose;
  }

  /** Angles by name, in degrees. */
  angles(pose) {
    return this.lifter.angles(pose, { up: this.up });
  }
}

/** Milliseconds that a call takes. */
function meanTime(call) {
  const start = performance.now();
  let count = 0;
  let passed = 0;
  while (passed < MEASURED_FOR) {
    call();
    count++;
    passed = performance.now() - start;
  }
  return passed / count;
}
