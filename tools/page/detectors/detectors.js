/* The detectors: which there are, what they take, and how one is started. */

import { Problem } from "../footage.js";
import { fetchAll } from "../store.js";

/* A detector is { format, detect(frame), close() }.  detect() gives { keypoints, format, width, height }, or null if
 * nobody is seen. */
const KNOWN = {
  "blazepose-lite": { name: "BlazePose lite", needsWebgl: true, start: (at) => startBlazepose(at, 0) },
  "blazepose-full": { name: "BlazePose full", needsWebgl: true, start: (at) => startBlazepose(at, 1) },
  "blazepose-heavy": { name: "BlazePose heavy", needsWebgl: true, start: (at) => startBlazepose(at, 2) },
  "movenet-lightning": { name: "MoveNet lightning", needsWebgl: false, start: startMovenet },
};

async function startBlazepose(folder, complexity) {
  const { Blazepose } = await import("./blazepose.js");
  return Blazepose.start(folder, complexity);
}

async function startMovenet(folder) {
  const { Movenet } = await import("./movenet.js");
  return Movenet.start(folder);
}

export const nameOf = (id) => KNOWN[id].name;
export const needsWebgl = (id) => KNOWN[id].needsWebgl;

/** Bytes of a detector, as a text. */
export const sizeOf = (files) => `${Math.round(files.reduce((sum, { bytes }) => sum + bytes, 0) / 1e6)} MB`;

/** Which of these to begin with: without a graphics processor, that which needs none. */
export function preferred(ids) {
  const fast = ids.find((id) => id === "blazepose-full") ?? ids[0];
  return graphics() === "hardware" ? fast : (ids.find((id) => !needsWebgl(id)) ?? fast);
}

/** "none", "software" or "hardware": what WebGL 2 runs on. */
export function graphics() {
  const context = document.createElement("canvas").getContext("webgl2");
  if (!context) return "none";
  const names = context.getExtension("WEBGL_debug_renderer_info");
  const renderer = String(context.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : context.RENDERER));
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(renderer) ? "software" : "hardware";
}

/** Starts a detector.
 *   installed  { folder, files }: where its files are
 *   progress   called while they are loaded, with bytes that are there and wanted */
export async function startDetector(id, { folder, files }, progress) {
  const { name, start } = KNOWN[id];
  if (needsWebgl(id) && graphics() === "none")
    throw new Problem(`${name} needs WebGL 2, which this browser does not offer. MoveNet does without: choose it in the settings.`);
  try {
    await fetchAll(files, progress);
  } catch (error) {
    throw new Problem(
      `${name} is not stored on this device yet, and it cannot be loaded (${error.message}). ` +
        "Start it once while the server can be reached.",
    );
  }
  try {
    return await start(new URL(folder, document.baseURI).href);
  } catch (error) {
    throw new Problem(`${name} does not start: ${error.message}`);
  }
}
