/* The picture: a frame of a camera or a video with the joints on it, or the joints alone. */

import { BLACK, Surface, colours, css, disc, mix, nameJoints } from "./view/paint.js";
import { drawSkeleton } from "./view/skeleton.js";

const DARKER = 0.18; // of black over a photo, so that the joints show

export class PictureView {
  constructor(canvas, body, changed) {
    this.body = body;
    this.surface = new Surface(canvas, changed);
    this.show({ box: [0, 0, 1, 1] });
  }

  /** What is drawn from now on.
   *   box       left, top, right and bottom of what is shown, in the picture's pixels
   *   frame     the picture, or null
   *   joints    [14] of [x, y] in its pixels, or null: not seen
   *   ghosts    [14] of [x, y] where joints that are not seen can be taken, or null
   *   mirrored  is it shown as in a mirror? */
  show({ box, frame = null, joints = [], ghosts = [], mirrored = false }) {
    Object.assign(this, { box, frame, joints, ghosts, mirrored });
  }

  /** Pixels of the canvas for a pixel of the picture, and where its origin is. */
  fit() {
    const [left, top, right, bottom] = this.box;
    const { width, height } = this.surface;
    const scale = Math.min(width / (right - left), height / (bottom - top));
    return {
      scale,
      x: (width - scale * (left + right)) / 2,
      y: (height - scale * (top + bottom)) / 2,
    };
  }

  /** Where a point of the picture is on the canvas. */
  place([x, y]) {
    const { scale, x: x0, y: y0 } = this.fit();
    const across = x0 + scale * x;
    return [this.mirrored ? this.surface.width - across : across, y0 + scale * y];
  }

  /** Where the joints are on the canvas, also those that are not seen but can be taken; null: nowhere. */
  get places() {
    const points = this.joints.map((joint, i) => joint ?? this.ghosts[i] ?? null);
    return points.map((point) => point && this.place(point));
  }

  /** Which point of the picture is at a place of the canvas. */
  pointAt(x, y) {
    const { scale, x: x0, y: y0 } = this.fit();
    return [(x - x0) / scale, (y - y0) / scale];
  }

  /** names  are the joints named? */
  draw(names) {
    const context = this.surface.clear();
    const { scale } = this.fit();
    if (this.frame) this.drawFrame(context, scale);
    const joints = this.joints.map((joint) => joint && this.place(joint));
    const width = Math.min(7, Math.max(2, (scale * sizeOf(this.joints)) / 52));
    drawSkeleton(context, this.body, joints, width, this.frame !== null);
    const ghosts = this.ghosts.map((ghost) => ghost && this.place(ghost));
    ghosts.forEach((ghost, joint) => ghost && this.drawGhost(context, ghost, joint));
    if (!names) return;
    const background = this.frame ? mix(colours.page, colours.panel, 0.5) : colours.panel;
    nameJoints(context, this.body.names, this.places, this.surface.width, background);
  }

  drawFrame(context, scale) {
    const { frame, surface } = this;
    const [left, top, right, bottom] = this.box;
    const [x, y] = [(surface.width - scale * (right - left)) / 2, (surface.height - scale * (bottom - top)) / 2];
    context.save();
    if (this.mirrored) {
      context.translate(surface.width, 0);
      context.scale(-1, 1);
    }
    context.drawImage(frame, x, y, scale * (right - left), scale * (bottom - top));
    context.fillStyle = css(BLACK, DARKER);
    context.fillRect(x, y, scale * (right - left), scale * (bottom - top));
    context.restore();
  }

  drawGhost(context, [x, y], joint) {
    disc(context, x, y, 7);
    context.setLineDash([3, 3]);
    context.lineWidth = 1.5;
    context.strokeStyle = css(colours[this.body.jointSides[joint]]);
    context.stroke();
    context.setLineDash([]);
  }
}

/** How large a person is: the diagonal of the joints' box, in pixels. */
function sizeOf(joints) {
  const known = joints.filter(Boolean);
  if (known.length === 0) return 1;
  const extent = (axis) => {
    const values = known.map((point) => point[axis]);
    return Math.max(...values) - Math.min(...values);
  };
  return Math.hypot(extent(0), extent(1));
}
