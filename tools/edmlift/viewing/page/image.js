/* The 2D joints, on the picture that they were seen in if it is in the page. */

import { JOINT_COUNT } from "./joints.js";
import { BLACK, Surface, colours, css, mix, nameJoints } from "./paint.js";
import { drawRing, drawSkeleton } from "./skeleton.js";

const AHEAD = 8; // pictures that are decoded before they are needed

export class ImageView {
  constructor(canvas, recording, changed) {
    this.recording = recording;
    this.changed = changed;
    this.surface = new Surface(canvas, changed);
    this.photos = [];
    this.lastPhoto = null;
    this.points = [];
    const [left, top, right, bottom] = recording.image?.box ?? [0, 0, 1, 1];
    const picture = recording.pictures[0];
    this.box = recording.image || !picture ? [left, top, right, bottom] : [0, 0, picture.width, picture.height];
    this.person = recording.image ? this.measure() : 1;
    this.aspect = (this.box[2] - this.box[0]) / (this.box[3] - this.box[1]);
  }

  /** Pixels of the image that a person is large: half of the frames have more. */
  measure() {
    const { recording } = this;
    const sizes = [];
    const stride = Math.max(1, Math.floor(recording.frames / 500));
    for (let frame = 0; frame < recording.frames; frame += stride) {
      const points = [];
      for (let joint = 0; joint < JOINT_COUNT; joint++) points.push(recording.point(frame, joint));
      const known = points.filter(Boolean);
      if (known.length === 0) continue;
      const extent = (axis) => {
        const values = known.map((point) => point[axis]);
        return Math.max(...values) - Math.min(...values);
      };
      sizes.push(Math.hypot(extent(0), extent(1)));
    }
    return sizes.sort((a, b) => a - b)[Math.floor(sizes.length / 2)] || 1;
  }

  /** The picture of a frame, or the one before it until it is there; null: there are none. */
  photo(frame) {
    const count = this.recording.pictures.length;
    if (count === 0) return null;
    const index = count === 1 ? 0 : frame;
    for (let i = 0; i <= AHEAD; i++) this.load((index + i) % count);
    if (this.photos[index].ready) this.lastPhoto = this.photos[index];
    return this.lastPhoto;
  }

  load(index) {
    if (this.photos[index]) return;
    const picture = this.recording.pictures[index];
    const photo = new Image();
    this.photos[index] = photo;
    photo.pixels = [picture.width, picture.height];
    photo.onload = () => {
      photo.ready = true;
      this.changed();
    };
    photo.src = `data:image/jpeg;base64,${picture.data}`;
  }

  draw(frame, { names, hovered }) {
    const { recording, surface } = this;
    const context = surface.clear();
    const [left, top, right, bottom] = this.box;
    const scale = Math.min(surface.width / (right - left), surface.height / (bottom - top));
    const x0 = (surface.width - scale * (left + right)) / 2;
    const y0 = (surface.height - scale * (top + bottom)) / 2;
    const photo = this.photo(frame);
    if (photo) {
      context.drawImage(photo, x0, y0, scale * photo.pixels[0], scale * photo.pixels[1]);
      context.fillStyle = css(BLACK, 0.18);
      context.fillRect(x0, y0, scale * photo.pixels[0], scale * photo.pixels[1]);
    }
    this.points = [];
    for (let joint = 0; joint < JOINT_COUNT; joint++) {
      const point = recording.image && recording.point(frame, joint);
      this.points.push(point && [x0 + scale * point[0], y0 + scale * point[1]]);
    }
    const width = Math.min(7, Math.max(2, (scale * this.person) / 52));
    drawSkeleton(context, recording, this.points, width, photo !== null);
    const background = photo ? mix(colours.page, colours.panel, 0.5) : colours.panel;
    if (names) nameJoints(context, recording.names, this.points, surface.width, background);
    const point = this.points[hovered];
    if (point) drawRing(context, point[0], point[1], 10);
  }
}
