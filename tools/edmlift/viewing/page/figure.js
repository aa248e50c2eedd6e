/* The figure: a pose in 3D, on a floor, in mild perspective, with what is farthest drawn first. */

import { ANKLES, HEAD, JOINT_COUNT, MIDDLE, TORSO, floorOf } from "./joints.js";
import {
  BLACK, Surface, WHITE, capsule, colours, css, disc, mix, nameJoints,
} from "./paint.js";
import { drawRing } from "./skeleton.js";

const DISTANCE = 5; // metres from which the figure is looked at
const GRID_STEP = 0.25; // metres
const GRID_HALF = 8; // squares on each side
const FADE = 0.38; // of the background in what is farthest
const HOME = { azimuth: -30, elevation: 14, zoom: 1 }; // degrees
const VIEWS = {
  camera: { azimuth: 0, elevation: 12 },
  side: { azimuth: 90, elevation: 12 },
  back: { azimuth: 180, elevation: 12 },
  above: { azimuth: 0, elevation: 90 },
  reset: HOME,
};
const LEAST_ELEVATION = -5, MOST_ELEVATION = 90;
const LEAST_ZOOM = 0.5, MOST_ZOOM = 5;
const SWING = 320; // milliseconds that a change of view takes

// Metres: radius of the limbs at the joints, and at the middle of the hips.
const RADIUS = [
  0.04, 0.038, 0.05, 0.04, 0.028, 0.05, 0.04, 0.028, 0.058, 0.046, 0.032, 0.058, 0.046, 0.032, 0.042,
];
const TRUNK_RADIUS = 0.04; // of the collar bones and the pelvis, at most
const HEAD_RADIUS = 0.105;
const NECK_SHARE = 0.6; // of the way to the head that the neck is drawn

/** How much room poses take: height and radius of a cylinder around nearly all of them, metres. */
export function roomOf(poses) {
  const [heights, radii] = [[], []];
  for (const pose of poses) {
    const floor = floorOf(pose);
    let [height, radius] = [0, 0];
    for (let joint = 0; joint < JOINT_COUNT; joint++) {
      height = Math.max(height, floor - pose[3 * joint + 1]);
      radius = Math.max(radius, Math.hypot(pose[3 * joint], pose[3 * joint + 2]));
    }
    heights.push(height);
    radii.push(radius);
  }
  const most = (values, otherwise) =>
    values.sort((a, b) => a - b)[Math.floor(0.98 * (values.length - 1))] ?? otherwise;
  return {
    height: Math.max(0.6, most(heights, 1.6) + HEAD_RADIUS),
    radius: Math.max(0.45, most(radii, 0.5)) + HEAD_RADIUS,
  };
}

/* A pose is a Float32Array of x right, y down, z away from the camera in metres, of the 14 joints and
 * the middle of the hips. */
export class FigureView {
  /** body  { names, bones, jointSides }: bones are pairs of joints with their side
   *  room  what roomOf() says of the poses to come */
  constructor(canvas, body, room, changed) {
    this.body = body;
    this.room = room;
    this.surface = new Surface(canvas, changed);
    this.view = { ...HOME };
    this.swing = null;
    this.points = [];
  }

  /** Prepares project(): the numbers of the view. */
  aim() {
    const { width, height } = this.surface;
    const azimuth = (this.view.azimuth * Math.PI) / 180;
    const elevation = (this.view.elevation * Math.PI) / 180;
    const { height: tallest, radius } = this.room;
    const tall = tallest * Math.cos(elevation) + 2 * radius * Math.sin(elevation) ** 2;
    const fit = Math.min(width / (2.2 * radius), (height - 24) / (1.22 * tall));
    this.look = {
      ca: Math.cos(azimuth), sa: Math.sin(azimuth), ce: Math.cos(elevation), se: Math.sin(elevation),
      scale: fit * this.view.zoom, x: width / 2, y: height / 2,
    };
  }

  /** Metres right, up from the floor and near -> pixels, depth, and pixels a metre there. */
  project(right, up, near) {
    const { ca, sa, ce, se, scale, x, y } = this.look;
    const high = up - this.room.height / 2;
    const across = ca * right - sa * near;
    const forward = sa * right + ca * near;
    const depth = se * high + ce * forward;
    const pixels = (scale * DISTANCE) / Math.max(0.5, DISTANCE - depth);
    return [x + pixels * across, y - pixels * (ce * high - se * forward), depth, pixels];
  }

  projectAll(pose) {
    return Array.from({ length: JOINT_COUNT + 1 }, (_, joint) => {
      const i = 3 * joint;
      return this.project(pose[i], this.floor - pose[i + 1], -pose[i + 2]);
    });
  }

  /** Draws a pose, and a second, dashed one; either may be null.
   *   seen     bit j: joint j was seen
   *   hovered  a joint that gets a ring; -1: none */
  draw({ pose, truth = null, seen }, { names = false, hovered = -1 } = {}) {
    this.floor = pose || truth ? floorOf(pose ?? truth) : 0;
    this.aim();
    const context = this.surface.clear();
    this.drawFloor(context);
    this.drawCamera(context);
    this.points = [];
    if (pose) {
      this.drawShadow(context, pose);
      this.points = this.projectAll(pose);
      this.drawBody(context, this.points, seen);
    }
    if (truth) this.drawTruth(context, truth);
    const joints = this.points.slice(0, JOINT_COUNT);
    if (names) nameJoints(context, this.body.names, joints, this.surface.width, colours.panel);
    const point = this.points[hovered];
    if (point) drawRing(context, point[0], point[1], 11);
  }

  // ---- The floor --------------------------------------------------------------------------------

  drawFloor(context) {
    const side = 2 * GRID_HALF + 1;
    const at = [];
    for (let i = 0; i < side * side; i++) {
      const [column, row] = [(i % side) - GRID_HALF, Math.floor(i / side) - GRID_HALF];
      at.push(this.project(GRID_STEP * column, 0, GRID_STEP * row));
    }
    const levels = 8; // of alpha, a path each
    const paths = Array.from({ length: levels }, () => new Path2D());
    const add = (from, to, column, row) => {
      const distance = Math.hypot(column, row) / GRID_HALF;
      const level = Math.floor(levels * (1 - distance));
      if (level < 0) return;
      paths[Math.min(level, levels - 1)].moveTo(at[from][0], at[from][1]);
      paths[Math.min(level, levels - 1)].lineTo(at[to][0], at[to][1]);
    };
    for (let row = 0; row < side; row++)
      for (let column = 0; column < side; column++) {
        const [i, x, y] = [row * side + column, column - GRID_HALF, row - GRID_HALF];
        if (column + 1 < side) add(i, i + 1, x + 0.5, y);
        if (row + 1 < side) add(i, i + side, x, y + 0.5);
      }
    context.lineWidth = 1;
    paths.forEach((path, level) => {
      context.strokeStyle = css(colours.grid, (level + 1) / levels);
      context.stroke(path);
    });
  }

  /** An arrow on the floor, from the side of the camera towards the person. */
  drawCamera(context) {
    const start = Math.min(0.8, this.room.radius + 0.05);
    const corners = [[-0.07, start], [0.07, start], [0, start - 0.14]];
    context.beginPath();
    for (const [right, near] of corners) {
      const [x, y] = this.project(right, 0, near);
      context.lineTo(x, y);
    }
    context.closePath();
    context.fillStyle = css(colours.faint, 0.8);
    context.fill();
    const [x, y] = this.project(0.12, 0, start - 0.05);
    context.font = "11px system-ui, sans-serif";
    context.textBaseline = "middle";
    context.fillStyle = css(colours.faint);
    context.fillText("camera", x, y);
  }

  drawShadow(context, pose) {
    const ground = (joint) => this.project(pose[3 * joint], 0, -pose[3 * joint + 2]);
    const path = new Path2D();
    for (const [a, b] of this.body.bones) {
      const [from, to] = [ground(a), ground(b)];
      path.moveTo(from[0], from[1]);
      path.lineTo(to[0], to[1]);
    }
    const pixels = ground(MIDDLE)[3];
    for (const [metres, alpha] of [[0.2, 0.07], [0.17, 0.08], [0.14, 0.09], [0.11, 0.1], [0.07, 0.1]]) {
      context.lineWidth = metres * pixels;
      context.strokeStyle = css(colours.shadow, alpha);
      context.stroke(path);
    }
    for (const ankle of ANKLES) { // the nearer the foot, the darker
      const height = this.floor - pose[3 * ankle + 1];
      const [x, y, , scale] = ground(ankle);
      context.beginPath();
      context.ellipse(x, y, 0.1 * scale, 0.1 * scale * Math.max(0.12, this.look.se), 0, 0, 2 * Math.PI);
      context.fillStyle = css(colours.shadow, 0.75 * Math.max(0, 1 - height / 0.3));
      context.fill();
    }
  }

  // ---- The body ---------------------------------------------------------------------------------

  drawBody(context, points, seen) {
    const depths = points.map((point) => point[2]);
    const [far, near] = [Math.min(...depths), Math.max(...depths)];
    const strength = FADE * Math.min(1, (near - far) / 0.5);
    const fade = (side, depth) =>
      mix(colours[side], colours.panel, strength * (near > far ? (near - depth) / (near - far) : 0));
    const items = [];
    const add = (depth, paint) => items.push({ depth, paint });
    add(Math.min(...TORSO.map((joint) => depths[joint])) - 0.03, () => this.paintTorso(context, points));
    const over = [...depths]; // a joint is drawn over its own bones
    for (const [a, b, side] of this.body.bones) {
      const thickest = side === "trunk" ? TRUNK_RADIUS : 1;
      const radius = (joint) => Math.min(thickest, RADIUS[joint]);
      const depth = (depths[a] + depths[b]) / 2;
      over[a] = Math.max(over[a], depth);
      over[b] = Math.max(over[b], depth);
      const end = b === HEAD ? mix(points[a], points[b], NECK_SHARE) : points[b];
      add(depth, () => this.paintBone(context, points[a], end, radius(a), radius(b), fade(side, depth)));
    }
    add(depths[HEAD], () => this.paintHead(context, points[HEAD], fade("trunk", depths[HEAD])));
    for (let joint = 1; joint < JOINT_COUNT; joint++) {
      const side = this.body.jointSides[joint];
      const wasSeen = ((seen >> joint) & 1) === 1;
      add(over[joint] + 0.01, () =>
        this.paintJoint(context, points[joint], RADIUS[joint], fade(side, depths[joint]), wasSeen));
    }
    items.sort((a, b) => a.depth - b.depth);
    for (const item of items) item.paint();
  }

  paintTorso(context, points) {
    context.fillStyle = context.strokeStyle = css(colours.skin);
    context.lineWidth = 0.1 * points[MIDDLE][3];
    context.beginPath();
    for (const joint of TORSO) context.lineTo(points[joint][0], points[joint][1]);
    context.closePath();
    context.fill();
    context.stroke();
  }

  /** A limb, lit from above, with a rim of the background. */
  paintBone(context, a, b, aMetres, bMetres, colour) {
    const [ar, br] = [Math.max(1.6, aMetres * a[3]), Math.max(1.6, bMetres * b[3])];
    capsule(context, a[0], a[1], ar, b[0], b[1], br);
    context.lineWidth = 3;
    context.strokeStyle = css(colours.panel);
    context.stroke();
    const length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
    let [nx, ny] = [(b[1] - a[1]) / length, (a[0] - b[0]) / length];
    if (0.5 * nx + ny > 0) [nx, ny] = [-nx, -ny]; // towards the light, above on the left
    const [x, y, r] = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2, Math.max(ar, br)];
    const light = context.createLinearGradient(x + r * nx, y + r * ny, x - r * nx, y - r * ny);
    light.addColorStop(0, css(mix(colour, WHITE, 0.22)));
    light.addColorStop(0.55, css(colour));
    light.addColorStop(1, css(mix(colour, BLACK, 0.16)));
    context.fillStyle = light;
    context.fill();
  }

  paintHead(context, point, colour) {
    const radius = HEAD_RADIUS * point[3];
    const [x, y] = point;
    disc(context, x, y, radius);
    context.lineWidth = 3;
    context.strokeStyle = css(colours.panel);
    context.stroke();
    const light = context.createRadialGradient(
      x - 0.35 * radius, y - 0.4 * radius, 0.1 * radius, x, y, radius);
    light.addColorStop(0, css(mix(colour, WHITE, 0.35)));
    light.addColorStop(1, css(colour));
    context.fillStyle = light;
    context.fill();
  }

  /** A joint: light if it was seen, a ring if the lift made it up. */
  paintJoint(context, point, metres, colour, seen) {
    const radius = Math.max(1.8, 0.62 * metres * point[3]);
    disc(context, point[0], point[1], radius);
    context.fillStyle = css(seen ? mix(colour, WHITE, 0.4) : colours.panel);
    context.fill();
    if (seen) return;
    context.lineWidth = Math.max(1.5, 0.4 * radius);
    context.strokeStyle = css(colour);
    context.stroke();
  }

  drawTruth(context, truth) {
    const points = this.projectAll(truth);
    context.strokeStyle = css(colours.truth);
    const width = Math.max(1.5, 0.014 * points[MIDDLE][3]);
    context.lineWidth = width;
    context.lineCap = "butt";
    context.setLineDash([3 * width, 2 * width]);
    for (const [a, b] of this.body.bones) {
      context.beginPath();
      context.moveTo(points[a][0], points[a][1]);
      context.lineTo(points[b][0], points[b][1]);
      context.stroke();
    }
    context.setLineDash([]);
    context.lineCap = "round";
    context.fillStyle = css(colours.truth);
    for (let joint = 0; joint < JOINT_COUNT; joint++) {
      disc(context, points[joint][0], points[joint][1], Math.max(2, 0.016 * points[joint][3]));
      context.fill();
    }
  }

  // ---- The view ---------------------------------------------------------------------------------

  turn(azimuth, elevation) {
    this.swing = null;
    this.view.azimuth += azimuth;
    this.view.elevation =
      Math.min(MOST_ELEVATION, Math.max(LEAST_ELEVATION, this.view.elevation + elevation));
  }

  zoom(factor) {
    this.view.zoom = Math.min(MOST_ZOOM, Math.max(LEAST_ZOOM, this.view.zoom * factor));
  }

  /** Swings to a view of VIEWS, the short way round; at once if the reader wants little motion. */
  go(name, now) {
    const from = { ...this.view };
    const to = { ...from, ...VIEWS[name] };
    to.azimuth = from.azimuth + (((to.azimuth - from.azimuth + 180) % 360) + 360) % 360 - 180;
    const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
    if (still) Object.assign(this.view, to);
    this.swing = still ? null : { from, to, start: now };
  }

  /** Moves on a swing; true while there is one. */
  advance(now) {
    if (!this.swing) return false;
    const { from, to, start } = this.swing;
    const share = Math.min(1, Math.max(0, (now - start) / SWING));
    const eased = share * share * (3 - 2 * share);
    for (const part of ["azimuth", "elevation", "zoom"])
      this.view[part] = from[part] + (to[part] - from[part]) * eased;
    if (share === 1) this.swing = null;
    return true;
  }
}
