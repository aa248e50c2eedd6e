// edmlift: detected 2D joints of a person in, a 3D pose in metres out.  index.d.ts says what all of this does.
// SPDX-License-Identifier: MIT

const VERSION = "1.0.0";

const MODELS = ["direct_w8", "direct_w16", "direct_f32", "distances_w8", "distances_w16", "distances_f32"];

export const JOINTS = Object.freeze([
  "head", "neck_base",
  "right_shoulder", "right_elbow", "right_wrist", "left_shoulder", "left_elbow", "left_wrist",
  "right_hip", "right_knee", "right_ankle", "left_hip", "left_knee", "left_ankle",
]);

export const BONES = Object.freeze(
  [
    [1, 0], [1, 2], [2, 3], [3, 4], [1, 5], [5, 6], [6, 7],
    [1, 8], [8, 9], [9, 10], [1, 11], [11, 12], [12, 13],
  ].map(Object.freeze),
);

export const ANGLES = Object.freeze([
  "right_elbow_flexion", "left_elbow_flexion", "right_knee_flexion", "left_knee_flexion",
  "right_hip_flexion", "left_hip_flexion", "right_hip_abduction", "left_hip_abduction",
  "right_shoulder_elevation", "left_shoulder_elevation", "right_shoulder_plane", "left_shoulder_plane",
  "right_shoulder_flexion", "left_shoulder_flexion", "right_shoulder_abduction", "left_shoulder_abduction",
  "trunk_lean", "trunk_lean_forward", "trunk_lean_right", "heading",
]);

export const STATUSES = Object.freeze([
  "ok", "argument", "not_finite", "too_few_joints", "degenerate", "work_too_small", "model", "camera", "time", "body",
]);

const THE_JOINTS = "edmlift14";
const DETECTOR_THRESHOLD = 0.1; // docs/detectors.md says why
const MOST_BONES = 60; // EDML_MEASURED_POSES
const POSE_WORDS = 44; // of edml_pose: 42 coordinates, the misfit and the joints that were seen
const BY_SQUARE = 2; // edml_format.normalised: y comes before x
const [ARMS, LEGS] = [1, 2]; // edml_track.swapped
const LIFT_OPTIONS = ["format", "up", "width", "height", "focal", "camera", "threshold", "mirrored"];
const TRACK_OPTIONS = ["format", "up", "width", "height", "threshold", "mirrored", "fps", "holdBones"];

// ---- Loading ------------------------------------------------------------------------------------

// A program of one function, which has two instructions with SIMD.
const SIMD_PROGRAM = [
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11,
];

/** Where the package has a model. */
function beside(model) {
  const file = WebAssembly.validate(new Uint8Array(SIMD_PROGRAM)) ? model : `${model}_scalar`;
  return new URL(`./${file}.wasm`, import.meta.url);
}

/** What a place, an answer of fetch() or a promise of these stands for: bytes, or a compiled module. */
async function contentOf(source, name) {
  const isPlace = (value) => typeof value === "string" || value instanceof URL;
  try {
    const given = await source;
    const found = isPlace(given) ? await read(given) : given;
    if (found?.ok === false) throw new Error(`the server answered ${found.status} ${found.statusText ?? ""}`.trim());
    return typeof found?.arrayBuffer === "function" ? await found.arrayBuffer() : found;
  } catch (cause) {
    throw new Error(
      `${name} cannot be loaded${isPlace(source) ? ` from ${source}` : ""}: ${cause.message}. The .wasm files must lie ` +
        "beside index.js, or load({ wasm }) must say where the file is",
      { cause },
    );
  }
}

/** A file's bytes, or the answer of fetch(), which reads no files in Node.js. */
async function read(place) {
  const inNode = typeof process === "object" && process.versions?.node !== undefined;
  if (!inNode || /^(https?|data|blob):/.test(place)) return fetch(place);
  const files = "node:fs/promises"; // a name that bundlers do not look for
  const { readFile } = await import(/* webpackIgnore: true */ /* @vite-ignore */ files);
  return readFile(/^file:/.test(place) ? new URL(place) : place);
}

/** The exports of a model's program, which is checked. */
async function start(content, name) {
  const isModule = content instanceof WebAssembly.Module;
  if (!isModule && !(content instanceof ArrayBuffer) && !ArrayBuffer.isView(content)) {
    throw new TypeError("wasm must be a URL, an answer of fetch(), the file's bytes or a WebAssembly.Module");
  }
  let program;
  try {
    const module = isModule ? content : await WebAssembly.compile(content);
    program = (await WebAssembly.instantiate(module)).exports;
  } catch (cause) {
    throw new Error(`${name} is no WebAssembly that can run here: ${cause.message}`, { cause });
  }
  if (program.model_name === undefined) throw new Error(`${name} is not a file of this package`);
  const version = textAt(program, program.version.value);
  if (version !== VERSION) throw new Error(`${name} is of version ${version}, but index.js of ${VERSION}`);
  if (program.check_model() !== 0) throw new Error(`${name} is damaged: its weights have another checksum`);
  return program;
}

function textAt(program, address) {
  const bytes = new Uint8Array(program.memory.buffer, address);
  return String.fromCharCode(...bytes.subarray(0, bytes.indexOf(0)));
}

export async function load(options = {}) {
  check(options, ["model", "wasm"], "load()");
  const { model, wasm } = options;
  if (model !== undefined && !MODELS.includes(model)) {
    throw new RangeError(`model ${quoted(model)} is not known; there are ${MODELS.join(", ")}`);
  }
  const name = model ?? (wasm === undefined ? MODELS[0] : "wasm");
  const program = await start(await contentOf(wasm ?? beside(name), name), name);
  const found = textAt(program, program.model_name());
  if (model !== undefined && found !== model) {
    throw new Error(`wasm has the model ${quoted(found)}, not ${quoted(model)}`);
  }
  return new Lifter(program);
}

// ---- Arguments ----------------------------------------------------------------------------------

const quoted = (value) => (typeof value === "string" ? JSON.stringify(value) : String(value));

function check(options, known, of) {
  if (typeof options !== "object" || options === null) {
    throw new TypeError(`options of ${of} must be an object, not ${quoted(options)}`);
  }
  const unknown = Object.keys(options).find((name) => !known.includes(name));
  if (unknown !== undefined) throw new TypeError(`${of} has no option ${unknown}; there are ${known.join(", ")}`);
}

/** So many finite numbers; what: a sentence that says what they must be. */
function numbers(values, count, what) {
  const given = Array.from(values ?? []);
  if (given.length === count && given.every(Number.isFinite)) return given;
  throw new RangeError(`${what}, not ${quoted(values)}`);
}

function readUp(up) {
  if (up === undefined) return undefined;
  const what = "up must be three finite numbers, not all 0";
  const given = numbers(up, 3, what);
  if (given.every((number) => Math.fround(number) === 0)) throw new RangeError(what);
  return given;
}

/** Width and height of the picture; undefined: not known. */
function readSize({ width, height }) {
  if (width === undefined && height === undefined) return undefined;
  if ([width, height].every((edge) => Number.isFinite(edge) && edge > 0)) return [width, height];
  throw new RangeError(`width and height must both be pixels, over 0, not ${quoted(width)} and ${quoted(height)}`);
}

/** fx, fy, cx, cy of the camera; undefined: not known. */
function readCamera({ camera, focal, mirrored }, size) {
  if (camera === undefined && focal === undefined) return undefined;
  if (camera !== undefined && focal !== undefined) throw new RangeError("give either focal or camera");
  if (size === undefined && (focal !== undefined || mirrored)) {
    throw new RangeError(`${focal !== undefined ? "focal" : "camera with mirrored"} needs width and height`);
  }
  const what = camera === undefined ? "focal must be pixels, over 0" : "camera must be fx, fy, cx, cy; fx, fy over 0";
  const given = numbers(camera ?? [focal, focal, size[0] / 2, size[1] / 2], 4, what);
  if (given[0] > 0 && given[1] > 0) return given;
  throw new RangeError(`${what}, not ${quoted(camera ?? focal)}`);
}

function readThreshold(threshold, format) {
  if (threshold === undefined) return format === THE_JOINTS ? 0 : DETECTOR_THRESHOLD;
  if (Number.isFinite(threshold) && threshold >= 0) return threshold;
  throw new RangeError(`threshold must be a finite number of 0 or more, not ${quoted(threshold)}`);
}

// ---- Keypoints ----------------------------------------------------------------------------------

/** The keypoints of a person one by one: objects, arrays, null. */
function split(keypoints, layout, formats) {
  if (typeof keypoints?.length !== "number") {
    throw new TypeError(`keypoints must be an array of ${layout.count}, not ${quoted(keypoints)}`);
  }
  const given = Array.from(keypoints);
  const isFlat = typeof given[0] === "number";
  const each = isFlat ? given.length / layout.count : 1;
  if (isFlat ? each !== 2 && each !== 3 : given.length !== layout.count) {
    throw new RangeError(wrongCount(given.length, isFlat ? [2, 3] : [1], layout, formats));
  }
  if (!isFlat) return given;
  return Array.from({ length: layout.count }, (_, k) => given.slice(each * k, each * (k + 1)));
}

/** each: how many there may be a keypoint, numbers or keypoints. */
function wrongCount(found, each, { name, count }, formats) {
  const wanted = each.map((times) => times * count).join(" or ");
  const others = Object.keys(formats).filter((other) => each.some((times) => found === times * formats[other]));
  const hint = others.length > 0 ? `; these may be of format ${others.join(", ")}` : "";
  return `format ${quoted(name)} has ${wanted} ${each.length > 1 ? "numbers" : "keypoints"}, not ${found}${hint}`;
}

/** What an object, an array or null says, as the format has it; c is undefined where none is given. */
function numbersOf(keypoint, index, layout) {
  if (keypoint === null || keypoint === undefined) return [NaN, NaN, undefined];
  const isObject = Object(keypoint) === keypoint && "x" in keypoint;
  const { x, y } = isObject ? keypoint : {};
  const c = keypoint.score ?? keypoint.confidence ?? keypoint.visibility ?? keypoint.c;
  const objects = layout.normalised === BY_SQUARE ? [y, x, c] : [x, y, c]; // arrays have y first there
  const found = isObject ? objects : [keypoint[0], keypoint[1], keypoint[2]];
  if (found.every((number, n) => typeof number === "number" || (n === 2 && number === undefined))) return found;
  throw new TypeError(`keypoint ${index} must be { x, y, score }, [x, y] or [x, y, score] of numbers`);
}

// ---- The program --------------------------------------------------------------------------------

/** A model's program and its memory, in which glue.c has variables that are written and read here. */
class Engine {
  constructor(program) {
    const { buffer } = program.memory; // never grows
    this.program = program;
    this.floats = new Float32Array(buffer);
    this.integers = new Int32Array(buffer);
    this.bytes = new Uint8Array(buffer);
    this.layouts = this.#readFormats();
    this.formats = Object.freeze(Object.fromEntries([...this.layouts.values()].map((f) => [f.name, f.count])));
  }

  /** What is known of each format, by its name. */
  #readFormats() {
    const layouts = [{ name: THE_JOINTS, index: -1, count: JOINTS.length, normalised: 0 }];
    for (let index = 0, at; (at = this.program.format_at(index)) !== 0; index++) {
      const name = textAt(this.program, this.integers[at / 4]);
      layouts.push({ name, index, count: this.bytes[at + 4], normalised: this.bytes[at + 5] });
    }
    return new Map(layouts.map((layout) => [layout.name, layout]));
  }

  /** The address of a variable, counted in words of 4 bytes. */
  word(name) {
    return this.program[name].value / 4;
  }

  number(name) {
    return this.integers[this.word(name)];
  }

  /** LiftOptions, checked. */
  settings(options) {
    const { format = THE_JOINTS } = options;
    const layout = this.layouts.get(format);
    if (layout === undefined) {
      throw new RangeError(`format ${quoted(format)} is not known; there are ${[...this.layouts.keys()].join(", ")}`);
    }
    const size = readSize(options);
    if (size === undefined && layout.normalised) {
      throw new RangeError(`keypoints of format ${quoted(format)} are normalised: give width and height of the picture`);
    }
    return {
      layout,
      size,
      up: readUp(options.up),
      camera: readCamera(options, size),
      threshold: readThreshold(options.threshold, format),
      mirrored: Boolean(options.mirrored),
    };
  }

  /** Writes settings for the next call. */
  set({ layout, size = [0, 0], up, camera, threshold, mirrored }) {
    const at = this.word("options");
    this.integers.set([layout.index, mirrored, up !== undefined, camera !== undefined], at);
    this.floats.set([threshold, ...size, ...(up ?? [0, 0, 0]), ...(camera ?? [0, 0, 0, 0])], at + 4);
  }

  /** Writes a person's keypoints and settings for the next call. */
  write(keypoints, settings) {
    const seen = Math.max(1, 2 * settings.threshold); // the confidence of what has none
    const found = split(keypoints, settings.layout, this.formats).flatMap((keypoint, index) => {
      const [first, second, c = seen] = numbersOf(keypoint, index, settings.layout);
      return [first, second, c];
    });
    this.floats.set(found, this.word("keypoints"));
    this.set(settings);
  }

  /** Throws if a call has found keypoints of a normalised format to be in pixels. */
  expectNormalised(is, { layout }) {
    if (is) return;
    throw new RangeError(
      `keypoints of format ${quoted(layout.name)} are normalised, 0 to 1 within the picture, and these are in pixels: ` +
        "divide x by the picture's width and y by its height",
    );
  }

  /** The first pose, and the joints that it comes from. */
  pose() {
    const { floats, integers } = this;
    const status = -this.number("status");
    const at = this.word("poses");
    const points = this.word("joints");
    const keypoints = floats.slice(points, points + 42);
    const bits = integers[at + 43];
    return {
      status: STATUSES[status],
      joints: status === 0 ? floats.slice(at, at + 42) : new Float32Array(42).fill(NaN),
      seen: JOINTS.map((_, j) => (status === 0 ? ((bits >> j) & 1) === 1 : keypoints[3 * j + 2] > 0)),
      keypoints,
      quality: status === 0 ? floats[this.word("quality")] : NaN,
      misfit: status === 0 ? floats[at + 42] : NaN,
    };
  }
}

// ---- What users call ----------------------------------------------------------------------------

export class Lifter {
  #engine;

  constructor(program) {
    if (program?.memory === undefined) throw new TypeError("load() makes a Lifter");
    this.#engine = new Engine(program);
    this.model = textAt(program, program.model_name());
    this.version = VERSION;
    this.formats = this.#engine.formats;
    Object.freeze(this);
  }

  lift(keypoints, options = {}) {
    check(options, LIFT_OPTIONS, "lift()");
    const engine = this.#engine;
    const settings = engine.settings(options);
    engine.write(keypoints, settings);
    const lifted = engine.program.lift(1);
    engine.expectNormalised(lifted >= 0, settings);
    if (lifted === 1) engine.program.measure_quality();
    return engine.pose();
  }

  liftMany(keypoints, options = {}) {
    check(options, LIFT_OPTIONS, "liftMany()");
    const settings = this.#engine.settings(options);
    const each = 3 * settings.layout.count;
    const count = keypoints?.length / each;
    if (!Number.isInteger(count)) {
      const { name } = settings.layout;
      throw new RangeError(`format ${quoted(name)} has ${each} numbers a person, and ${keypoints?.length} are no multiple`);
    }
    const given = ArrayBuffer.isView(keypoints) ? keypoints : Float32Array.from(keypoints);
    const poses = { joints: new Float32Array(42 * count).fill(NaN), status: new Uint8Array(count), count };
    this.#engine.set(settings);
    const most = this.#engine.number("most_people");
    for (let first = 0; first < count; first += most) {
      const people = Math.min(most, count - first);
      this.#liftSome(poses, first, people, given.subarray(first * each, (first + people) * each), settings);
    }
    return poses;
  }

  #liftSome(poses, first, people, keypoints, settings) {
    const { floats, integers, program } = this.#engine;
    const [status, at] = [this.#engine.word("status"), this.#engine.word("poses")];
    floats.set(keypoints, this.#engine.word("keypoints"));
    this.#engine.expectNormalised(program.lift(people) >= 0, settings);
    for (let n = 0; n < people; n++) {
      const pose = at + n * POSE_WORDS;
      poses.status[first + n] = -integers[status + n];
      if (integers[status + n] === 0) poses.joints.set(floats.subarray(pose, pose + 42), 42 * (first + n));
    }
  }

  angles(pose, options = {}) {
    check(options, ["up"], "angles()");
    if (pose?.joints?.length !== 42 || pose.seen?.length !== 14) throw new TypeError("angles() takes a pose of lift()");
    const engine = this.#engine;
    const { floats, integers, program } = engine;
    engine.set(engine.settings({ up: options.up }));
    floats.set(pose.joints, engine.word("poses"));
    integers[engine.word("poses") + 43] = pose.seen.reduce((bits, is, j) => bits | (is << j), 0);
    const measured = program.measure_angles() === 0;
    const at = engine.word("degrees");
    return Object.fromEntries(ANGLES.map((name, n) => [name, measured ? floats[at + n] : NaN]));
  }

  track(options = {}) {
    return new Track(this.#engine, options);
  }
}

export class Track {
  #engine;
  #settings;
  #fps;
  #bones;
  #person;
  #frames;

  constructor(engine, options) {
    if (!(engine instanceof Engine)) throw new TypeError("Lifter.track() makes a Track");
    check(options, TRACK_OPTIONS, "track()");
    const { fps, holdBones = MOST_BONES } = options;
    if (fps !== undefined && !(fps > 0 && fps <= 1000)) {
      throw new RangeError(`fps must be over 0 and at most 1000, not ${quoted(fps)}`);
    }
    if (!(Number.isInteger(holdBones) && holdBones >= 0 && holdBones <= MOST_BONES)) {
      throw new RangeError(`holdBones must be 0 to ${MOST_BONES} poses, not ${quoted(holdBones)}`);
    }
    this.#engine = engine;
    this.#settings = engine.settings(options);
    [this.#fps, this.#bones] = [fps, holdBones];
    this.reset();
  }

  reset() {
    this.#engine.program.start_person();
    this.#person = this.#state().slice();
    this.#frames = 0;
  }

  lift(keypoints, milliseconds) {
    const engine = this.#engine;
    const time = this.#time(milliseconds);
    this.#ask(keypoints, () => engine.program.track(time, this.#bones) === 1);
    this.#person = this.#state().slice();
    this.#frames++;
    const pose = engine.pose();
    return { ...pose, ...this.#report(pose.status === "ok") };
  }

  distance(keypoints, milliseconds) {
    const time = this.#time(milliseconds);
    return this.#ask(keypoints, () => this.#engine.program.distance(time), (distance) => distance >= 0);
  }

  /** What a call of the program answers, with this person's state and these keypoints. */
  #ask(keypoints, call, isFine = (answer) => answer) {
    this.#engine.write(keypoints, this.#settings);
    this.#state().set(this.#person);
    const answer = call();
    this.#engine.expectNormalised(isFine(answer), this.#settings);
    return answer;
  }

  /** Where the program has the state of a person. */
  #state() {
    const at = this.#engine.program.person.value;
    return this.#engine.bytes.subarray(at, at + this.#engine.number("person_bytes"));
  }

  #time(milliseconds) {
    const time = milliseconds ?? (this.#frames * 1000) / this.#fps;
    if (Number.isFinite(time)) return Math.floor(time) >>> 0;
    throw new RangeError(`a frame needs its time in milliseconds, or its track fps, not ${quoted(milliseconds)}`);
  }

  #report(isPose) {
    const at = this.#engine.word("report");
    const [elapsed, held, swapped, mirrored, aside] = isPose ? this.#engine.integers.subarray(at, at + 5) : [0, 0, 0, 0, 0];
    return {
      held: JOINTS.map((_, j) => ((held >> j) & 1) === 1),
      swapped: { arms: (swapped & ARMS) !== 0, legs: (swapped & LEGS) !== 0 },
      mirrored: mirrored !== 0,
      elapsed: elapsed >>> 0,
      aside: aside !== 0,
    };
  }
}
