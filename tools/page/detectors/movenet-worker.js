/* MoveNet beside the page, so that the page goes on while it looks.
 *
 * In: { folder } once, where tfjs.js, the backend and the network are; then { pixels, side }, RGBA of a square.
 * Out: { answer }, which is y, x and score of each keypoint as shares of the square; or { error }. */

let tf = null;
let network = null;

async function start(folder) {
  tf = await import(`${folder}tfjs.esm.js`);
  tf.setWasmPaths(folder);
  await tf.setBackend("wasm");
  network = await tf.loadGraphModel(`${folder}movenet-lightning.json`);
  return true;
}

async function look(pixels, side) {
  const rgba = new Uint8Array(pixels);
  const rgb = new Int32Array(3 * side * side);
  for (let i = 0, j = 0; j < rgb.length; i += 4, j += 3)
    for (let colour = 0; colour < 3; colour++) rgb[j + colour] = rgba[i + colour];
  const input = tf.tensor4d(rgb, [1, side, side, 3], "int32");
  const output = network.execute(input);
  const found = await output.data();
  input.dispose();
  output.dispose();
  return found;
}

self.onmessage = async ({ data: { folder, pixels, side } }) => {
  try {
    self.postMessage({ answer: folder ? await start(folder) : await look(pixels, side) });
  } catch (error) {
    self.postMessage({ error: error.message });
  }
};
