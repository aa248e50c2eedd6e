/* Watching footage: frame by frame through the detector and the lift, as fast as they go. */

const NEW_SHARE = 0.1; // of a frame in the means

export class Watching {
  /** lifting  a Lifting
   *  shown    called with each frame: { frame, time, pose }; no pose where nobody is seen */
  constructor(footage, detector, lifting, shown) {
    Object.assign(this, { footage, detector, lifting, shown });
    this.mirrored = false;
    this.looked = 0;
    this.detectorMs = NaN;
    this.rate = NaN;
    this.lastTime = -Infinity;
    this.lastShown = NaN;
    this.begins = true;
  }

  /** Goes on until it is stopped or the footage is closed; begins with the frame that is there, because a video may
   * have been paused. */
  async run() {
    await this.detector.looking?.catch(() => {}); // for another Watching
    try {
      for (let next = this.footage.now(); next && !this.stopped; next = await this.footage.next())
        await this.look(next);
    } catch (error) {
      if (!this.stopped) throw error; // a detector may be closed while it looks
    }
  }

  stop() {
    this.stopped = true;
  }

  async look({ frame, time }) {
    if (time === this.lastTime) return;
    if (this.begins || time < this.lastTime) {
      this.lifting.cut();
      this.detector.cut();
      this.begins = false;
    }
    this.lastTime = time;
    const start = performance.now();
    this.detector.looking = this.detector.detect(frame);
    const found = await this.detector.looking;
    if (this.stopped || this.footage.closed) return;
    this.count(performance.now() - start);
    const pose = found && this.lifting.liftFrame(found, time, this.mirrored);
    this.shown({ frame, time, pose });
  }

  /** The next frame does not follow this one, which may still be looked at: the video was wound. */
  cut() {
    this.begins = true;
  }

  /** Takes the time of a frame into the means; the first one's includes what a detector prepares. */
  count(took) {
    const mean = (before, now) => (this.looked < 2 ? now : before + NEW_SHARE * (now - before));
    this.detectorMs = mean(this.detectorMs, took);
    const now = performance.now();
    const gap = now - this.lastShown;
    if (this.looked > 0) this.rate = 1000 / mean(1000 / this.rate, gap);
    this.lastShown = now;
    this.looked++;
  }
}
