/* Footage: the frames of a camera or a video file, as they come. */

const MOST_SIDE = 720; // pixels of a frame that detectors are shown: their networks take 256 at most

/** A problem that the page can say in a sentence. */
export class Problem extends Error {}

export class Footage {
  /** live  a camera, and no file */
  constructor(live) {
    this.live = live;
    this.video = document.createElement("video");
    this.frames = [0, 1].map(() => document.createElement("canvas")); // one is shown, one is looked at
    this.closed = false;
    this.waiting = null;
  }

  /** Opens a camera, the one with this id or any; a Problem says why not. */
  static async camera(id) {
    if (!navigator.mediaDevices?.getUserMedia)
      throw new Problem(
        "The browser gives cameras only to pages of https:// and http://localhost. Open the page there, " +
          "or choose a video file.",
      );
    const wanted = { width: { ideal: 640 }, height: { ideal: 480 } };
    const video = { ...wanted, ...(id ? { deviceId: { exact: id } } : { facingMode: "user" }) };
    let stream;
    try {
      stream = await navigator.mediaDevices.getUserMedia({ video });
    } catch (error) {
      throw new Problem(CAMERA_PROBLEMS[error.name] ?? `The camera does not start: ${error.message}`);
    }
    const footage = new Footage(true);
    footage.video.srcObject = stream;
    footage.track = stream.getVideoTracks()[0];
    footage.track.addEventListener("ended", () => footage.lost?.());
    return footage.begin();
  }

  /** Opens a file of the user's; a Problem if the browser cannot play it. */
  static async file(file) {
    const footage = new Footage(false);
    footage.url = URL.createObjectURL(file);
    footage.video.src = footage.url;
    footage.video.loop = true;
    try {
      return await footage.begin();
    } catch {
      footage.close();
      throw new Problem(
        `This browser cannot play ${file.name}. It can play most .mp4 (H.264) and .webm files: ` +
          "ffmpeg -i VIDEO video.mp4 makes one.",
      );
    }
  }

  /** Plays, once the first frame is there. */
  async begin() {
    const { video } = this;
    video.muted = video.playsInline = true;
    video.className = "spoken"; // in the page, because some browsers play no other, but not to be seen
    video.ariaHidden = "true";
    document.body.append(video);
    await new Promise((resolve, reject) => {
      video.onloadeddata = resolve;
      video.onerror = () => reject(new Error("no video"));
    });
    if (video.videoWidth === 0) throw new Error("no picture");
    await video.play();
    return this;
  }

  /** A camera that looks at its user, as those of laptops do. */
  get facesUser() {
    return this.live && this.track.getSettings().facingMode !== "environment";
  }

  get device() {
    return this.track?.getSettings().deviceId;
  }

  /** The frame that is to be seen: its canvas, and its time in milliseconds. */
  now() {
    return { frame: this.grab(), time: this.live ? performance.now() : 1000 * this.video.currentTime };
  }

  /** Waits for the next frame; null once closed. */
  async next() {
    const { video } = this;
    const time = await new Promise((resolve) => {
      this.waiting = resolve;
      if (this.closed) resolve(null);
      else if (video.requestVideoFrameCallback)
        video.requestVideoFrameCallback((now, { mediaTime }) => resolve(this.live ? now : 1000 * mediaTime));
      else requestAnimationFrame((now) => resolve(this.live ? now : 1000 * video.currentTime));
    });
    return this.closed ? null : { frame: this.grab(), time };
  }

  /** A copy of the frame, because the video goes on while it is looked at. */
  grab() {
    const { video } = this;
    const frame = this.frames.pop();
    this.frames.unshift(frame);
    const share = Math.min(1, MOST_SIDE / Math.max(video.videoWidth, video.videoHeight));
    const [width, height] = [video.videoWidth, video.videoHeight].map((side) => Math.round(share * side));
    if (frame.width !== width || frame.height !== height) Object.assign(frame, { width, height });
    frame.getContext("2d").drawImage(video, 0, 0, width, height);
    return frame;
  }

  close() {
    this.closed = true;
    this.waiting?.(null);
    this.video.pause();
    for (const track of this.video.srcObject?.getTracks() ?? []) track.stop();
    this.video.srcObject = null;
    this.video.remove();
    if (this.url) URL.revokeObjectURL(this.url);
  }
}

const CAMERA_PROBLEMS = {
  NotAllowedError:
    "The browser may not use the camera. Allow it, beside the page's address, and start again; or choose a " +
    "video file.",
  NotFoundError: "There is no camera. Connect one and start again, or choose a video file.",
  OverconstrainedError: "That camera is gone. Start again with another one.",
  NotReadableError: "The camera does not start: perhaps another program has it. Close that one and start again.",
};

/** The cameras that there are; their names are known once one was allowed. */
export async function listCameras() {
  const devices = await navigator.mediaDevices.enumerateDevices();
  return devices.filter((device) => device.kind === "videoinput");
}
