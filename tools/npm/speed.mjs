// Poses a second on one core, by the processor's time that a process takes: JSON of each model's medians.
//
//   node speed.mjs FOLDER_OF_THE_PACKAGE KEYPOINTS.csv MODEL...
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const ROUNDS = 9;
const ROUND_MS = 200;
const [folder, csv, ...models] = process.argv.slice(2);
const { load } = await import(pathToFileURL(`${folder}/index.js`));

const lines = readFileSync(csv, "utf8").split("\n").filter((line) => line !== "" && line[0] !== "#");
const people = lines.map((line) => line.split(",").map(Number));
const every = Float32Array.from(people.flat());
const asObjects = (numbers) =>
  Array.from({ length: numbers.length / 3 }, (_, k) => {
    const [x, y, score] = numbers.slice(3 * k, 3 * k + 3);
    return { x, y, score };
  });
const objects = people.map(asObjects);

/** The median of several rounds. */
function rate(call, poses) {
  const rates = Array.from({ length: ROUNDS }, () => {
    const start = process.cpuUsage().user;
    let lifted = 0;
    let taken = 0;
    while (taken < 1000 * ROUND_MS) {
      call();
      lifted += poses;
      taken = process.cpuUsage().user - start;
    }
    return (1e6 * lifted) / taken;
  });
  return Math.round(rates.sort((a, b) => a - b)[(ROUNDS - 1) / 2]);
}

const found = {};
for (const model of models) {
  const lifter = await load({ wasm: `${folder}/${model}.wasm` });
  const single = () => objects.forEach((keypoints) => lifter.lift(keypoints));
  const many = () => lifter.liftMany(every);
  for (const warm of [single, many]) for (let k = 0; k < 50; k++) warm();
  found[model] = { lift: rate(single, people.length), liftMany: rate(many, people.length) };
}
console.log(JSON.stringify(found));
