/** edmlift: detected 2D joints of a person in, a 3D pose in metres out.  The C library, compiled to WebAssembly. */

/** A network: `direct` is smaller and faster, `distances` a little better on noisy views.  `w8` and `w16` are
 * weights of 8 and of 16 bits, in a half and a quarter of the bytes of `f32`. */
export type ModelName =
  | "direct_w8"
  | "direct_w16"
  | "direct_f32"
  | "distances_w8"
  | "distances_w16"
  | "distances_f32";

/** The order in which a detector gives its keypoints; `edmlift14` are the {@link JOINTS} themselves.
 * `blazepose33` is normalised by the picture's size, as MediaPipe gives it, and `movenet17` are y, x and score in
 * shares of a padded square, as MoveNet's tensor has them: both need `width` and `height`.  Keypoints in pixels, such
 * as those of TensorFlow.js, are `coco17` for MoveNet, PoseNet and YOLO-pose. */
export type Format =
  | "edmlift14"
  | "coco17"
  | "movenet17"
  | "body25"
  | "body25b"
  | "coco18"
  | "mpi15"
  | "halpe26"
  | "blazepose33"
  | "cpm14"
  | "mpii16"
  | "lsp14"
  | "crowdpose14"
  | "aic14"
  | "h36m17_right_first"
  | "h36m17_left_first";

/** Why a person has no pose: fewer than 10 joints were seen; a number is NaN or infinite; points are equal, on a line,
 * or like no person; this camera cannot have seen it; a frame of a track is not later than the one before. */
export type Status = "ok" | "not_finite" | "too_few_joints" | "degenerate" | "camera" | "time" | "argument";

/** Three numbers: x right, y down, z away from the camera. */
export type Point = ArrayLike<number>;

/** A keypoint as many detectors for the browser give it.  Pixels, or what the format has. */
export interface Keypoint {
  x: number;
  y: number;
  /** The confidence: the first of `score`, `confidence`, `visibility` and `c` that is there counts.  None: seen. */
  score?: number;
  confidence?: number;
  visibility?: number;
  c?: number;
}

/** The keypoints of a person: objects; or arrays of x, y and perhaps a confidence; or all these numbers in one array.
 * A keypoint was not seen where its confidence is not above the threshold, where x or y is NaN, and at exactly 0, 0
 * and -1, -1, by which detectors mark what they did not find. */
export type Keypoints = ArrayLike<number> | ArrayLike<ArrayLike<number>> | ArrayLike<Keypoint>;

/** The 14 joints by name, in the order of everything that has a number a joint.  Left and right are the subject's. */
export const JOINTS: readonly string[];

/** The 13 bones as pairs of joints; the first of a pair is nearer to the neck. */
export const BONES: readonly (readonly [number, number])[];

/** The names of the angles, in degrees (docs/angles.md). */
export const ANGLES: readonly string[];

/** The name of each number in {@link Poses.status}. */
export const STATUSES: readonly string[];

export interface Options {
  /** Default: "direct_w8". */
  model?: ModelName;
  /** Where the model's .wasm is, if not beside this module; or what is in it.  A bundler's URL, for example. */
  wasm?: Wasm | Promise<Wasm>;
}

/** A URL, or in Node.js a path; the answer of fetch(); the bytes of the file; or the file, compiled. */
export type Wasm = string | { readonly href: string } | FetchedFile | ArrayBuffer | ArrayBufferView | WebAssembly.Module;

/** What is asked of a Response. */
export interface FetchedFile {
  readonly ok: boolean;
  readonly status: number;
  arrayBuffer(): Promise<ArrayBuffer>;
}

declare global {
  namespace WebAssembly {
    interface Module {} // for projects without the types of browsers
  }
}

/** Loads a model.  It can load several; each lifter is independent, and no call waits for anything.
 * Throws an Error that says what is wrong: an unknown model, a file that is not there or damaged. */
export function load(options?: Options): Promise<Lifter>;

export interface LiftOptions {
  /** Default: "edmlift14". */
  format?: Format;
  /** The upward direction in the camera's axes, of any length, as an accelerometer shows it; (0, -1, 0) before a
   * level camera.  Default: not known. */
  up?: Point;
  /** The picture's size in pixels.  Keypoints outside are not seen, whatever the detector invents there. */
  width?: number;
  height?: number;
  /** The camera's focal length in pixels, if it is known; needs the picture's size.  A person at the edge of a wide
   * picture comes out turned without it. */
  focal?: number;
  /** Instead of `focal`, the whole camera: fx, fy, cx, cy in pixels. */
  camera?: ArrayLike<number>;
  /** A confidence up to this is not seen.  Default: 0.1; 0 with "edmlift14". */
  threshold?: number;
  /** The picture is a mirror image, as selfie cameras show it.  Default: false. */
  mirrored?: boolean;
}

export interface Pose {
  /** "ok", or why there is no pose. */
  status: Status;
  /** [14][3], metres: x right, y down, z away from the camera, origin midway between the hips.  All 14, also those
   * that were not seen.  NaN without a pose. */
  joints: Float32Array;
  /** [14]: was the joint seen? */
  seen: boolean[];
  /** [14][3]: x, y in pixels and the confidence of the joints that the pose was lifted from. */
  keypoints: Float32Array;
  /** The probability that the mean error of the joints is under 100 mm, 0 to 1 (docs/body.md).  NaN without a pose. */
  quality: number;
  /** Metres: how far the network's points are from the picture (RMS).  NaN without a pose. */
  misfit: number;
}

/** Many people, lifted by one call. */
export interface Poses {
  /** [count][14][3], as in {@link Pose}. */
  joints: Float32Array;
  /** [count]: 0 is a pose; {@link STATUSES} names the others. */
  status: Uint8Array;
  /** How many people there are. */
  count: number;
}

export class Lifter {
  private constructor();
  readonly model: ModelName;
  /** The C library's, such as "1.0.0". */
  readonly version: string;
  /** How many keypoints each format has. */
  readonly formats: Readonly<Record<Format, number>>;

  /** Lifts a person.  What cannot be lifted has a status; a RangeError or TypeError says that arguments are wrong:
   * another number of keypoints than the format has, a format that there is not, no size where it is needed. */
  lift(keypoints: Keypoints, options?: LiftOptions): Pose;

  /** Lifts many people.
   * @param keypoints [count][K][3]: x, y and confidence of each, K as the format has it */
  liftMany(keypoints: ArrayLike<number>, options?: LiftOptions): Poses;

  /** The angles of a pose by name, in degrees.  NaN where there is no pose, where a joint that the angle needs was not
   * seen, and where there is no direction to measure (docs/angles.md).
   * @param options.up as for a lift; default: a level camera.  The trunk's lean and the heading depend on it. */
  angles(pose: Pose, options?: { up?: Point }): Record<string, number>;

  /** Starts the video of a person. */
  track(options?: TrackOptions): Track;
}

export interface TrackOptions extends Omit<LiftOptions, "focal" | "camera"> {
  /** Frames a second: `Track.lift` then needs no times. */
  fps?: number;
  /** So many poses, 60 at most, measure the person's bones, whose lengths all poses then have; 0: bones are as long
   * as each pose has them.  Default: 60. */
  holdBones?: number;
}

/** A pose of a video. */
export interface TrackedPose extends Pose {
  /** [14]: not seen in this frame, but lately. */
  held: boolean[];
  /** Had the detector exchanged right and left?  `keypoints` are as the track took them. */
  swapped: { arms: boolean; legs: boolean };
  /** Not the mirror image that this frame alone would give. */
  mirrored: boolean;
  /** Milliseconds since this person's frame before; 0 at a start. */
  elapsed: number;
  /** Somebody else, for a moment: lifted by itself. */
  aside: boolean;
}

/** The video of one person: frames as they come, each made steady by those before (docs/video.md).  One for each
 * person. */
export class Track {
  private constructor();
  /** Lifts the next frame.
   * @param milliseconds of the frame, by any clock, later than the one before; else the status is "time".  Without it,
   *   frames are 1000 / fps apart */
  lift(keypoints: Keypoints, milliseconds?: number): TrackedPose;
  /** How far these keypoints are from where the track expects them, in body sizes: the same person's are within about
   * 0.3; beyond 1 it is another person.  Infinity if the track cannot say, as at its start. */
  distance(keypoints: Keypoints, milliseconds: number): number;
  /** Forgets all frames. */
  reset(): void;
}
