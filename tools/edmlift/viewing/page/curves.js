/* Curves over time, a row each, with a cursor that follows; and the strip of the time line. */

import { digits } from "./joints.js";
import { Surface, colours, css } from "./paint.js";
import { MISSING } from "./recording.js";

const EDGE = 8; // pixels beside the time axis: half the slider's thumb

/** The frames that are shown over the width of a plot. */
export class TimeAxis {
  constructor(frames) {
    this.frames = frames;
    this.first = 0;
    this.last = Math.max(1, frames - 1);
  }

  x(frame, width) {
    return EDGE + ((frame - this.first) / (this.last - this.first)) * (width - 2 * EDGE);
  }

  frame(x, width) {
    const share = (x - EDGE) / Math.max(1, width - 2 * EDGE);
    const frame = Math.round(this.first + share * (this.last - this.first));
    return Math.min(this.frames - 1, Math.max(0, frame));
  }

  /** Shows so many frames around one, 0: all; true if that changes anything. */
  show(count, frame) {
    const all = this.frames - 1;
    const length = count === 0 || count > all ? Math.max(1, all) : count;
    const first = length >= all ? 0 : Math.min(all - length, Math.max(0, frame - length / 2));
    if (first === this.first && first + length === this.last) return false;
    this.first = first;
    this.last = first + length;
    return true;
  }
}

export class CurveRow {
  constructor(row, axis, changed) {
    Object.assign(this, { row, axis });
    this.element = make("div", "row");
    const name = make("div", "row-name", row.name);
    name.title = row.about;
    this.plot = make("div", "plot");
    const canvas = make("canvas");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", `${row.name} over time: ${row.about}`);
    this.cursor = make("div", "cursor");
    const [top, bottom] = [row.high, row.low].map((value) => amountText(row, value, 0));
    this.plot.append(canvas, make("span", "scale top", top), make("span", "scale bottom", bottom),
      this.cursor);
    this.values = make("div", "row-values");
    this.element.append(name, this.plot, this.values);
    this.solid = row.lines.filter((line) => !line.dashed);
    this.amounts = [];
    this.dots = [];
    for (const line of this.solid) {
      const dot = make("div", `dot ${line.side}`);
      const text = make("span");
      const amount = make("span", "amount");
      if (this.solid.length > 1) {
        text.append(make("span", `swatch ${line.side}`), make("span", "spoken", `${line.side} `));
        text.title = `subject's ${line.side}`;
      }
      text.append(amount);
      this.values.append(text);
      this.plot.append(dot);
      this.amounts.push(amount);
      this.dots.push(dot);
    }
    this.surface = new Surface(canvas, changed);
  }

  y(value) {
    const { low, high } = this.row;
    return this.surface.height - 5 - ((value - low) / (high - low)) * (this.surface.height - 10);
  }

  draw(withTruth) {
    const { surface, row } = this;
    const context = surface.clear();
    context.lineWidth = 1;
    context.fillStyle = css(colours.panel);
    context.fillRect(EDGE, 3, surface.width - 2 * EDGE, surface.height - 6);
    for (const line of row.lines) {
      if (line.dashed && !withTruth) continue;
      context.strokeStyle = css(colours[line.side]);
      context.lineWidth = line.dashed ? 1.2 : 1.6;
      context.setLineDash(line.dashed ? [4, 3] : []);
      context.stroke(this.path(line));
    }
    context.setLineDash([]);
  }

  /** A line through the values; where there are many a pixel, from the least to the greatest. */
  path(line) {
    const { axis, surface, row } = this;
    const path = new Path2D();
    const from = Math.max(0, Math.floor(axis.first)), to = Math.min(axis.frames - 1, Math.ceil(axis.last));
    const perPixel = (axis.last - axis.first) / Math.max(1, surface.width);
    const group = Math.max(1, Math.floor(perPixel));
    let before = null; // the value before, unless it was missing or jumps over the end of the scale
    for (let start = from; start <= to; start += group) {
      let [low, high, last] = [Infinity, -Infinity, null];
      for (let i = start; i < start + group && i <= to; i++) {
        if (line.values[i] === MISSING) continue;
        last = line.values[i] * row.step;
        low = Math.min(low, last);
        high = Math.max(high, last);
      }
      if (last !== null) {
        const x = axis.x(start, surface.width);
        const jumps = row.wraps && before !== null && Math.abs(last - before) > 180;
        if (before === null || jumps) {
          path.moveTo(x, this.y(low));
          path.lineTo(x + 0.01, this.y(low)); // a value alone is a dot
        }
        if (group > 1 && !(row.wraps && high - low > 180)) path.lineTo(x, this.y(low)), path.lineTo(x, this.y(high));
        path.lineTo(x, this.y(last));
      }
      before = last;
    }
    return path;
  }

  /** Moves the cursor to a frame and shows the values there. */
  follow(frame) {
    const x = this.axis.x(frame, this.surface.width);
    this.cursor.style.transform = `translateX(${x}px)`;
    this.solid.forEach((line, i) => {
      const count = line.values[frame];
      const known = count !== MISSING;
      const value = count * this.row.step;
      this.dots[i].hidden = !known;
      if (known) this.dots[i].style.transform = `translate(${x}px, ${this.y(value)}px)`;
      this.amounts[i].textContent = known ? amountText(this.row, value, this.row.digits) : "–";
    });
  }
}

/** The strip behind the slider: the frames without a pose, and what the curves show. */
export class Strip {
  constructor(canvas, recording, changed) {
    this.recording = recording;
    this.axis = new TimeAxis(recording.frames);
    this.surface = new Surface(canvas, changed);
  }

  draw(frame, shown) {
    const { surface, recording, axis } = this;
    const context = surface.clear();
    const middle = surface.height / 2;
    const width = surface.width;
    context.lineWidth = 4;
    const line = (from, to, colour) => {
      context.strokeStyle = css(colour);
      context.beginPath();
      context.moveTo(axis.x(from, width), middle);
      context.lineTo(axis.x(to, width), middle);
      context.stroke();
    };
    line(0, axis.last, colours.line);
    line(0, frame, colours.faint);
    context.fillStyle = css(colours.refused);
    const half = (width - 2 * EDGE) / axis.last / 2;
    let start = -1;
    for (let i = 0; i <= recording.frames; i++) { // runs of frames, because there may be 100,000
      const refused = i < recording.frames && recording.isRefused(i);
      if (refused && start < 0) start = i;
      if (refused || start < 0) continue;
      const left = axis.x(start, width) - Math.min(half, 6);
      const right = axis.x(i - 1, width) + Math.min(half, 6);
      context.fillRect(left, middle - 13, Math.max(2, right - left), 6);
      start = -1;
    }
    if (shown.first > 0 || shown.last < axis.last) {
      context.fillStyle = css(colours.faint);
      const left = axis.x(shown.first, width);
      context.fillRect(left, surface.height - 6, Math.max(3, axis.x(shown.last, width) - left), 3);
    }
  }
}

/** A value of a row with its unit. */
function amountText(row, value, count) {
  return digits(value, count) + (row.unit === "mm" ? " mm" : row.unit);
}

/** A new element, with its class and text. */
export function make(tag, classes = "", text = "") {
  const element = document.createElement(tag);
  if (classes) element.className = classes;
  if (text) element.textContent = text;
  return element;
}
