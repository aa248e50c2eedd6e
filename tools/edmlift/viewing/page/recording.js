/* The recording: numbers of all frames, unpacked from the text in the page. */

import { JOINT_COUNT, addMiddle, inWords } from "./joints.js";

export const MISSING = -32768; // stands for NaN

function unpack(text, Numbers) {
  const bytes = atob(text);
  const array = new Uint8Array(bytes.length);
  for (let i = 0; i < bytes.length; i++) array[i] = bytes.charCodeAt(i);
  return new Numbers(array.buffer);
}

export function readRecording() {
  const element = document.getElementById("data");
  const given = JSON.parse(element.textContent);
  element.remove(); // an hour of text need not be kept twice
  given.status = unpack(given.status, Uint16Array);
  given.seen = unpack(given.seen, Uint16Array);
  given.poses = unpack(given.poses, Int16Array);
  given.truth = given.truth && unpack(given.truth, Int16Array);
  if (given.image) {
    given.image.points = unpack(given.image.points, Int16Array);
    given.image.confidence = unpack(given.image.confidence, Uint8Array);
  }
  for (const row of given.curves)
    for (const line of row.lines) line.values = unpack(line.values, Int16Array);
  return new Recording(given);
}

class Recording {
  constructor(given) {
    Object.assign(this, given);
    this.names = this.joints.map(inWords);
    this.ok = this.statuses.indexOf("ok");
    this.refused = this.status.reduce((count, code) => count + (code !== this.ok), 0);
  }

  /** Words for the status of a frame. */
  statusOf(frame) {
    return inWords(this.statuses[this.status[frame]]);
  }

  isRefused(frame) {
    return this.status[frame] !== this.ok;
  }

  /** The next frame without a pose, from the start again behind the last one; -1: there is none. */
  nextRefused(frame) {
    for (let step = 1; step <= this.frames; step++) {
      const at = (frame + step) % this.frames;
      if (this.isRefused(at)) return at;
    }
    return -1;
  }

  /** Is there a pose with a joint that was not seen? */
  hasUnseen() {
    const all = (1 << JOINT_COUNT) - 1;
    return this.seen.some((seen, frame) => seen !== all && !this.isRefused(frame));
  }

  /** Metres of the joints and the middle of the hips into out[15 * 3]; false if there is no pose. */
  pose(frame, out) {
    return readPose(this.poses, frame, out);
  }

  truePose(frame, out) {
    return this.truth !== null && readPose(this.truth, frame, out);
  }

  /** So many of the poses, or all: of each frame its own, or the true one. */
  *samples(count) {
    const out = new Float32Array(3 * (JOINT_COUNT + 1));
    const stride = Math.max(1, Math.floor(this.frames / count));
    for (let frame = 0; frame < this.frames; frame += stride)
      if (this.pose(frame, out) || this.truePose(frame, out)) yield out;
  }

  /** Pixels of a joint in the image, or null where it was not seen. */
  point(frame, joint) {
    const { points, step, origin } = this.image;
    const i = (frame * JOINT_COUNT + joint) * 2;
    if (points[i] === MISSING || points[i + 1] === MISSING) return null;
    return [origin[0] + step * points[i], origin[1] + step * points[i + 1]];
  }

  confidence(frame, joint) {
    return this.image.confidence[frame * JOINT_COUNT + joint] / 255;
  }

  seconds(frame) {
    return frame / this.fps;
  }
}

function readPose(lengths, frame, out) {
  const start = frame * JOINT_COUNT * 3;
  if (lengths[start] === MISSING) return false;
  for (let i = 0; i < JOINT_COUNT * 3; i++) out[i] = lengths[start + i] / 1000;
  addMiddle(out);
  return true;
}

/** 75 s -> "1:15.00". */
export function clockText(seconds) {
  const minutes = Math.floor(seconds / 60);
  const rest = (seconds - 60 * minutes).toFixed(2);
  return minutes > 0 ? `${minutes}:${rest.padStart(5, "0")}` : `${rest} s`;
}
