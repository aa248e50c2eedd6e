/* MoveNet lightning, by the WebAssembly backend of TensorFlow.js in a worker: 17 keypoints of one person. */

import { around, whole } from "./crops.js";

const SIDE = 192; // pixels of the network's square input
const SURE = 0.4; // mean score of shoulders and hips below which nobody is seen: it always finds something, with up to 0.3
const TRUNK = [5, 6, 11, 12];

export class Movenet {
  constructor(worker) {
    this.worker = worker;
    this.square = null;
    const canvas = document.createElement("canvas");
    canvas.width = canvas.height = SIDE;
    this.context = canvas.getContext("2d", { willReadFrequently: true });
  }

  static async start(folder) {
    const worker = new Worker(new URL("movenet-worker.js", import.meta.url), { type: "module" });
    await ask(worker, { folder });
    return new Movenet(worker);
  }

  /** The keypoints in pixels of a frame; null: nobody is seen.  In a first frame it looks twice: at all of it, and at the
   * person there. */
  async detect(frame) {
    const { width, height } = frame;
    if (!this.square) this.square = around(await this.look(frame, whole(width, height)), width, height);
    const keypoints = await this.look(frame, this.square);
    this.square = around(keypoints, width, height);
    const score = TRUNK.reduce((sum, k) => sum + keypoints[k][2], 0) / TRUNK.length;
    if (score < SURE) return null;
    return { keypoints, format: "coco17", width, height };
  }

  /** What the network finds in a square of a frame: x and y in pixels of the frame, and a score. */
  async look(frame, { left, top, side }) {
    this.context.fillRect(0, 0, SIDE, SIDE);
    this.context.drawImage(frame, left, top, side, side, 0, 0, SIDE, SIDE);
    const { data } = this.context.getImageData(0, 0, SIDE, SIDE);
    const found = await ask(this.worker, { pixels: data.buffer, side: SIDE }, [data.buffer]);
    return Array.from({ length: found.length / 3 }, (_, k) => {
      const [y, x, score] = found.subarray(3 * k, 3 * k + 3);
      return [left + side * x, top + side * y, score];
    });
  }

  /** The next frame is of something else. */
  cut() {
    this.square = null;
  }

  close() {
    this.worker.terminate();
  }
}

/** Asks the worker; an Error of its own is thrown here. */
function ask(worker, question, given = []) {
  return new Promise((resolve, reject) => {
    worker.onmessage = ({ data }) => (data.error ? reject(new Error(data.error)) : resolve(data.answer));
    worker.onerror = (event) => reject(new Error(event.message ?? "its worker was not loaded"));
    worker.postMessage(question, given);
  });
}
