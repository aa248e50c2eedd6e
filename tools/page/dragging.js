/* A skeleton whose joints are dragged: by mouse, finger or arrow keys. */

import { nearest } from "./view/paint.js";

const REACH = 44; // pixels from a joint within which a finger takes it
const ROOM = 0.2; // of a skeleton's extent that is free on each side
const STEP = 0.01, LARGE_STEP = 0.05; // of the box, by an arrow key, and with shift
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export class DragBoard {
  /** element  over the picture; its buttons, one a joint, are made here
   *  picture  a PictureView, which says where points are
   *  changed  called when a joint was moved, hidden or chosen */
  constructor(element, picture, names, changed) {
    Object.assign(this, { element, picture, names, changed });
    this.chosen = -1;
    this.held = null; // the pointer that drags, and how far it is from the joint
    this.buttons = names.map((_, joint) => this.makeButton(joint));
    element.append(...this.buttons);
    element.addEventListener("pointerdown", (event) => this.take(event));
    element.addEventListener("pointermove", (event) => this.drag(event));
    for (const name of ["pointerup", "pointercancel"])
      element.addEventListener(name, () => this.release());
    element.addEventListener("dblclick", () => this.chosen >= 0 && this.toggle());
  }

  makeButton(joint) {
    const button = document.createElement("button");
    button.type = "button";
    button.addEventListener("focus", () => this.choose(joint));
    button.addEventListener("keydown", (event) => this.press(event));
    button.addEventListener("click", (event) => event.detail === 0 && this.toggle()); // not a pointer's
    return button;
  }

  /** Starts from the joints of a skeleton [x, y]; all are seen. */
  start(points) {
    this.points = points.map((point) => [...point]);
    this.seen = points.map(() => true);
    const corner = (choose) => [0, 1].map((axis) => choose(...points.map((point) => point[axis])));
    const [low, high] = [corner(Math.min), corner(Math.max)];
    const half = (0.5 + ROOM) * Math.max(high[0] - low[0], high[1] - low[1]);
    const middle = [0, 1].map((axis) => (low[axis] + high[axis]) / 2);
    this.box = [middle[0] - half, middle[1] - half, middle[0] + half, middle[1] + half];
    this.chosen = -1;
    this.changed();
  }

  /** What the lift takes: x, y and confidence of each joint. */
  get keypoints() {
    return this.points.map(([x, y], joint) => [x, y, this.seen[joint] ? 1 : 0]);
  }

  /** What a PictureView shows. */
  get shown() {
    const only = (seen) => this.points.map((point, joint) => (this.seen[joint] === seen ? point : null));
    return { box: this.box, joints: only(true), ghosts: only(false) };
  }

  choose(joint) {
    if (joint === this.chosen) return;
    this.chosen = joint;
    this.changed();
  }

  toggle(seen = !this.seen[this.chosen]) {
    this.seen[this.chosen] = seen;
    this.changed();
  }

  move(joint, [x, y]) {
    const [left, top, right, bottom] = this.reach();
    this.points[joint] = [Math.min(right, Math.max(left, x)), Math.min(bottom, Math.max(top, y))];
    this.changed();
  }

  /** What of the picture is in sight: joints stay in there. */
  reach() {
    const { width, height } = this.picture.surface;
    return [...this.picture.pointAt(8, 8), ...this.picture.pointAt(width - 8, height - 8)];
  }

  press(event) {
    const [right, down] = ARROWS[event.key] ?? [0, 0];
    if (right || down) {
      const step = (event.shiftKey ? LARGE_STEP : STEP) * (this.box[2] - this.box[0]);
      const [x, y] = this.points[this.chosen];
      this.move(this.chosen, [x + step * right, y + step * down]);
    } else if (event.key === "Delete" || event.key === "Backspace") this.toggle();
    else return;
    event.preventDefault();
  }

  // ---- Pointers -----------------------------------------------------------------------------------

  take(event) {
    if (this.held || event.button !== 0) return;
    const at = this.at(event);
    const places = this.points.map((point) => this.picture.place(point));
    const joint = nearest(places, ...at, REACH);
    event.preventDefault(); // or the button beneath would take the focus
    if (joint < 0) return;
    this.element.setPointerCapture(event.pointerId);
    this.held = { pointer: event.pointerId, away: [places[joint][0] - at[0], places[joint][1] - at[1]] };
    this.element.classList.add("dragged");
    this.buttons[joint].focus({ preventScroll: true, focusVisible: false });
    this.choose(joint);
  }

  drag(event) {
    if (this.held?.pointer !== event.pointerId) return;
    const [x, y] = this.at(event);
    const { away } = this.held;
    this.move(this.chosen, this.picture.pointAt(x + away[0], y + away[1]));
  }

  release() {
    this.held = null;
    this.element.classList.remove("dragged");
  }

  at(event) {
    const box = this.element.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
  }

  // ---- The buttons --------------------------------------------------------------------------------

  /** Puts the buttons where the joints are, and says so. */
  follow() {
    this.buttons.forEach((button, joint) => {
      const [x, y] = this.picture.place(this.points[joint]);
      button.style.transform = `translate(${x}px, ${y}px)`;
      button.setAttribute("aria-label", `${this.names[joint]}: ${this.say(joint)}`);
      button.setAttribute("aria-pressed", String(this.seen[joint]));
    });
  }

  /** "478, 466", and whether it is seen. */
  say(joint) {
    const [x, y] = this.points[joint].map(Math.round);
    return `${x}, ${y}${this.seen[joint] ? "" : ", not seen"}`;
  }
}
