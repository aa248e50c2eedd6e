// Runs bits.c as WebAssembly: node bits.mjs bits.wasm
//
// SPDX-License-Identifier: MIT
import { readFileSync } from "node:fs";

function text(at) {
  const bytes = new Uint8Array(instance.exports.memory.buffer);
  return new TextDecoder().decode(bytes.subarray(at, bytes.indexOf(0, at)));
}

const hex = (word) => (word >>> 0).toString(16).padStart(8, "0");

function print(what, model, high, low, count, of, done) {
  console.log(`${text(what)}${text(model)} ${hex(high)}${hex(low)} ${count} of ${of} ${text(done)}`);
}

const program = readFileSync(process.argv[2]);
const { instance } = await WebAssembly.instantiate(program, { bits: { print } });
instance.exports.main();
