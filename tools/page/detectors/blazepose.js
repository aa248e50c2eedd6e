/* BlazePose, by MediaPipe's package for browsers: on the graphics processor, 33 keypoints of one person. */

const READY = new Map(); // folders whose script is loaded

export class Blazepose {
  constructor(pose) {
    this.pose = pose;
    this.landmarks = null;
    pose.onResults(({ poseLandmarks }) => (this.landmarks = poseLandmarks ?? null));
  }

  /** complexity  0, 1, 2: lite, full, heavy */
  static async start(folder, complexity) {
    await script(`${folder}pose.js`);
    const pose = new window.Pose({ locateFile: (name) => folder + name });
    pose.setOptions({ modelComplexity: complexity, smoothLandmarks: true });
    await pose.initialize();
    return new Blazepose(pose);
  }

  /** The keypoints as shares of a frame's width and height; null: nobody is seen. */
  async detect(frame) {
    await this.pose.send({ image: frame });
    if (!this.landmarks) return null;
    const { width, height } = frame;
    return { keypoints: this.landmarks, format: "blazepose33", width, height };
  }

  /** The next frame is of something else. */
  cut() {
    this.pose.reset();
  }

  close() {
    return this.pose.close();
  }
}

/** Loads a script that is no module, once. */
function script(address) {
  if (!READY.has(address))
    READY.set(
      address,
      new Promise((resolve, reject) => {
        const element = document.createElement("script");
        element.src = address;
        element.crossOrigin = "anonymous";
        element.onload = resolve;
        element.onerror = () => reject(new Error(`${address} was not loaded`));
        document.head.append(element);
      }),
    );
  return READY.get(address);
}
