// MoveNet as a filter, by the WebAssembly backend of TensorFlow.js.
//
//     node movenet.mjs MODEL.json SIDE < squares > keypoints
//
// In: images of SIDE x SIDE pixels, three bytes each, RGB.  Out, as soon as an image is there: 17
// keypoints as the network gives them, y, x and score, float32.

import { readFileSync, writeSync } from "node:fs";

import "@tensorflow/tfjs-backend-wasm";
import { loadGraphModel } from "@tensorflow/tfjs-converter";
import * as tf from "@tensorflow/tfjs-core";

const STDOUT = 1;

// What loadGraphModel() takes, of a model's two files.
function read(path) {
    const { modelTopology, signature, weightsManifest } = JSON.parse(readFileSync(path));
    const weights = readFileSync(path.replace(/json$/, "bin"));
    return {
        modelTopology,
        signature,
        weightSpecs: weightsManifest[0].weights,
        weightData: new Uint8Array(weights).buffer,
    };
}

function detect(model, bytes, side) {
    const found = tf.tidy(() =>
        model.execute(tf.tensor(bytes, [1, side, side, 3], "int32")).dataSync(),
    );
    return new Uint8Array(Float32Array.from(found).buffer);
}

const [path, side] = [process.argv[2], Number(process.argv[3])];
await tf.setBackend("wasm");
const model = await loadGraphModel({ load: async () => read(path) });

const size = side * side * 3;
let waiting = Buffer.alloc(0);
for await (const chunk of process.stdin) {
    waiting = Buffer.concat([waiting, chunk]);
    for (; waiting.length >= size; waiting = waiting.subarray(size)) {
        writeSync(STDOUT, detect(model, Int32Array.from(waiting.subarray(0, size)), side));
    }
}
