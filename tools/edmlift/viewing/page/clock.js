/* The clock: which frame is shown, and how it moves on. */

export class Clock {
  constructor(frames, fps, moved) {
    Object.assign(this, { frames, fps, moved });
    this.frame = 0;
    this.speed = 1;
    this.playing = false;
    this.position = 0; // frames, with a fraction while it plays
    this.before = null; // time of the last tick
  }

  /** Goes to a frame, within the recording. */
  go(frame) {
    this.position = Math.min(this.frames - 1, Math.max(0, frame));
    this.set(Math.floor(this.position));
  }

  step(frames) {
    this.pause();
    this.go(this.frame + frames);
  }

  play() {
    if (this.frames < 2) return;
    this.playing = true;
    this.before = null;
    this.moved();
  }

  pause() {
    this.playing = false;
    this.moved();
  }

  /** Moves on to a time in milliseconds; starts again behind the last frame. */
  tick(now) {
    if (!this.playing) return;
    const passed = this.before === null ? 0 : Math.min(250, now - this.before);
    this.before = now;
    this.position = (this.position + (passed / 1000) * this.fps * this.speed) % this.frames;
    this.set(Math.floor(this.position));
  }

  set(frame) {
    if (frame === this.frame) return;
    this.frame = frame;
    this.moved();
  }
}
