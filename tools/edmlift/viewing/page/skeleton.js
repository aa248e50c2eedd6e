/* The 2D joints and the bones between them, over a picture or alone. */

import { HEAD, HIPS, NECK, TORSO } from "./joints.js";
import { BLACK, WHITE, colours, css, disc, mix } from "./paint.js";

/** Draws joints [x, y] or null, in pixels of the canvas.
 *   body   { bones, jointSides }: pairs of joints with their side, and the side of each joint
 *   width  pixels of the bones
 *   photo  is there a picture behind? */
export function drawSkeleton(context, body, joints, width, photo) {
  const points = [...joints, middleOf(HIPS.map((hip) => joints[hip]))];
  const rim = photo ? WHITE : colours.panel;
  const trunk = photo ? mix(colours.trunk, BLACK, colours.trunk[0] > 128 ? 0.7 : 0) : colours.trunk;
  const shade = (side) => (side === "trunk" ? trunk : colours[side]);
  if (!photo) drawSkin(context, points, width);
  const bones = body.bones.filter(([a, b]) => points[a] && points[b]);
  const stroke = ([a, b], colour, thickness) => {
    context.strokeStyle = css(colour);
    context.lineWidth = thickness;
    context.beginPath();
    context.moveTo(...points[a]);
    context.lineTo(...points[b]);
    context.stroke();
  };
  for (const bone of bones) stroke(bone, rim, 1.6 * width);
  for (const bone of bones) stroke(bone, shade(bone[2]), width);
  joints.forEach((point, joint) => {
    if (!point) return;
    disc(context, point[0], point[1], 1.02 * width);
    context.fillStyle = css(rim);
    context.fill();
    disc(context, point[0], point[1], 0.78 * width);
    context.fillStyle = css(shade(body.jointSides[joint]));
    context.fill();
  });
}

/** Head and torso, soft, behind the bones. */
function drawSkin(context, points, width) {
  context.fillStyle = context.strokeStyle = css(colours.skin);
  const corners = TORSO.map((joint) => points[joint]);
  if (corners.every(Boolean)) {
    context.lineWidth = 1.4 * width;
    context.beginPath();
    for (const corner of corners) context.lineTo(...corner);
    context.closePath();
    context.fill();
    context.stroke();
  }
  const [head, neck] = [points[HEAD], points[NECK]];
  if (head && neck) {
    disc(context, head[0], head[1], 0.42 * Math.hypot(head[0] - neck[0], head[1] - neck[1]));
    context.fill();
  }
}

/** The mean of points, of which some may be null. */
function middleOf(points) {
  const known = points.filter(Boolean);
  if (known.length === 0) return null;
  return [0, 1].map((axis) => known.reduce((sum, point) => sum + point[axis], 0) / known.length);
}

export function drawRing(context, x, y, radius) {
  disc(context, x, y, radius);
  context.lineWidth = 2;
  context.strokeStyle = css(colours.focus);
  context.stroke();
}
