// Does what a test asks for, by the package that is installed: JSON in, JSON out.
//
//   in   [{ load: Options, calls: [[method, ...arguments], ...] }, ...]
//   out  for each: [answer, ...], or { error }
//
// "track" takes options and frames, each the arguments of Track.lift; "again" lifts them a second time.
import { readFileSync } from "node:fs";

import * as edmlift from "edmlift";

const NUMBERS = { NaN, Infinity, "-Infinity": -Infinity };
const revive = (_, value) => NUMBERS[value] ?? value;

function write(key, value) {
  if (ArrayBuffer.isView(value)) {
    return { base64: Buffer.from(value.buffer, value.byteOffset, value.byteLength).toString("base64") };
  }
  return typeof value === "number" && !Number.isFinite(value) ? String(value) : value;
}

async function attempt(call) {
  try {
    return await call();
  } catch (error) {
    return { error: `${error.name}: ${error.message}` };
  }
}

function callOf(lifter, [method, ...given]) {
  if (method === "names") {
    const { load, Lifter, Track, ...names } = edmlift;
    return { ...names, ...lifter };
  }
  if (method === "angles") return lifter.angles(lifter.lift(given[0], given[1]), given[2]);
  if (method === "liftMany") return lifter.liftMany(Float32Array.from(given[0]), given[1]);
  if (method !== "track") return lifter[method](...given);
  const track = lifter.track(given[0]);
  const once = () => given[1].map((frame) => ({ distance: distanceOf(track, frame), ...track.lift(...frame) }));
  const first = once();
  track.reset();
  if (JSON.stringify(once(), write) !== JSON.stringify(first, write)) throw new Error("reset() left something");
  return first;
}

const distanceOf = (track, [keypoints, time]) => (time === undefined ? NaN : track.distance(keypoints, time));

const jobs = JSON.parse(readFileSync(0, "utf8"), revive);
const answers = [];
for (const { load, calls } of jobs) {
  const lifter = await attempt(() => edmlift.load(load));
  const answer = (call) => attempt(() => callOf(lifter, call));
  answers.push(lifter.error === undefined ? await Promise.all(calls.map(answer)) : lifter);
}
console.log(JSON.stringify(answers, write));
