/* Painting: canvases in sharp pixels, the colours of the style sheet, bones and joints. */

const MAX_DENSITY = 2.5; // device pixels a pixel; more costs time and shows nothing

/** A canvas that keeps the size of its box; calls changed() when that changes. */
export class Surface {
  constructor(canvas, changed) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.width = this.height = 0;
    new ResizeObserver(() => {
      if (this.fit()) changed();
    }).observe(canvas);
    this.fit();
  }

  fit() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const density = Math.min(devicePixelRatio || 1, MAX_DENSITY);
    if (width === this.width && height === this.height && density === this.density) return false;
    Object.assign(this, { width, height, density });
    this.canvas.width = Math.round(width * density);
    this.canvas.height = Math.round(height * density);
    return true;
  }

  /** An empty canvas, in CSS pixels. */
  clear() {
    const { context, density } = this;
    context.setTransform(density, 0, 0, density, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    context.lineCap = context.lineJoin = "round";
    return context;
  }
}

/** The colours of the style sheet as [red, green, blue], read again when the scheme changes. */
export const colours = {};

export function readColours() {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["right", "left", "trunk", "truth", "page", "panel", "text", "faint", "line",
    "grid", "skin", "shadow", "focus", "refused"]) {
    const value = style.getPropertyValue(`--${name}`).trim();
    colours[name] = [1, 3, 5].map((at) => parseInt(value.slice(at, at + 2), 16));
  }
}

export const WHITE = [255, 255, 255];
export const BLACK = [0, 0, 0];

export function css(colour, alpha = 1) {
  return `rgb(${colour.map(Math.round).join(" ")} / ${alpha})`;
}

/** A colour, and so much of another one in it, 0 to 1. */
export function mix(colour, other, amount) {
  return colour.map((value, i) => value + (other[i] - value) * amount);
}

/** The outline of two discs and what lies between them. */
export function capsule(context, ax, ay, ar, bx, by, br) {
  const length = Math.hypot(bx - ax, by - ay);
  context.beginPath();
  if (length <= Math.abs(ar - br) + 1e-6) {
    if (ar > br) context.arc(ax, ay, ar, 0, 2 * Math.PI);
    else context.arc(bx, by, br, 0, 2 * Math.PI);
    return;
  }
  const angle = Math.atan2(by - ay, bx - ax);
  const spread = Math.acos((ar - br) / length);
  context.arc(ax, ay, ar, angle + spread, angle - spread + 2 * Math.PI);
  context.arc(bx, by, br, angle - spread, angle + spread);
  context.closePath();
}

export function disc(context, x, y, radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
}

/** Text with a rim of its background. */
export function label(context, text, x, y, background) {
  context.font = "12px system-ui, sans-serif";
  context.textBaseline = "middle";
  context.lineWidth = 3;
  context.strokeStyle = css(background, 0.85);
  context.strokeText(text, x, y);
  context.fillStyle = css(colours.text);
  context.fillText(text, x, y);
}

/** Names of joints beside them [x, y] or null; each moves away from those already there. */
export function nameJoints(context, names, points, width, background) {
  const taken = [];
  context.font = "12px system-ui, sans-serif";
  points.forEach((point, joint) => {
    if (!point) return;
    const wide = context.measureText(names[joint]).width;
    const onRight = point[0] + wide + 14 < width;
    let [x, y] = [onRight ? point[0] + 9 : point[0] - wide - 9, point[1]];
    const crosses = (other) => Math.abs(other[1] - y) < 14 && x < other[0] + other[2] + 4 &&
      other[0] < x + wide + 4;
    for (let tries = 0; tries < 14 && taken.some(crosses); tries++)
      y = point[1] + 8 * Math.ceil((tries + 1) / 2) * (tries % 2 ? 1 : -1);
    taken.push([x, y, wide]);
    if (Math.abs(y - point[1]) > 8) {
      context.beginPath();
      context.moveTo(point[0], point[1]);
      context.lineTo(onRight ? x - 2 : x + wide + 2, y);
      context.lineWidth = 1;
      context.strokeStyle = css(colours.faint);
      context.stroke();
    }
    label(context, names[joint], x, y, background);
  });
}

/** The point [x, y] that is nearest to a place, within so many pixels; -1: none. */
export function nearest(points, x, y, within) {
  let [best, found] = [within, -1];
  points.forEach((point, i) => {
    if (!point) return;
    const distance = Math.hypot(point[0] - x, point[1] - y);
    if (distance < best) [best, found] = [distance, i];
  });
  return found;
}

/** Shows text in a tip beside a place of its panel; no text hides it. */
export function showTip(tip, text, x = 0, y = 0) {
  tip.hidden = !text;
  if (!text) return;
  tip.textContent = text;
  const { clientWidth: wide, clientHeight: high } = tip.parentElement;
  const left = Math.min(Math.max(4, x + 14), Math.max(4, wide - tip.offsetWidth - 4));
  const top = Math.min(Math.max(4, y + 14), Math.max(4, high - tip.offsetHeight - 4));
  tip.style.transform = `translate(${left}px, ${top}px)`;
}
