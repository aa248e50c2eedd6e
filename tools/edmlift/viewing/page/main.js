/* The page: its parts, what the reader does with them, and when they are drawn. */

import { Clock } from "./clock.js";
import { CurveRow, Strip, TimeAxis, make } from "./curves.js";
import { FigureView, roomOf } from "./figure.js";
import { ImageView } from "./image.js";
import { JOINT_COUNT, digits } from "./joints.js";
import { nearest, readColours, showTip } from "./paint.js";
import { clockText, readRecording } from "./recording.js";
import { changeView, followPointers, turnByKey } from "./turning.js";

const byId = (id) => document.getElementById(id);

const recording = readRecording();
const chosen = { names: false, withTruth: recording.truth !== null, hovered: -1, span: 0 };
const stale = { frame: true, curves: true }; // what has to be drawn
let waiting = false;

/** Draws at the next chance; `curves` as well if they changed. */
function redraw(curves = false) {
  stale.frame = true;
  stale.curves ||= curves;
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(drawPage);
}

readColours();
const clock = new Clock(recording.frames, recording.fps, redraw);
const imageView = new ImageView(byId("image"), recording, () => redraw());
const figureView = new FigureView(byId("figure"), recording, roomOf(recording.samples(2000)), () => redraw());
const axis = new TimeAxis(recording.frames);
const rows = recording.curves.map((row) => new CurveRow(row, axis, () => redraw(true)));
const strip = new Strip(byId("strip"), recording, () => redraw());
const cost = { milliseconds: 0, draws: 0 };

const buffers = [0, 1].map(() => new Float32Array(3 * (JOINT_COUNT + 1)));

/** The pose of a frame, and the true one; null where there is none. */
function posesOf(frame) {
  const [pose, truth] = buffers;
  return {
    pose: recording.pose(frame, pose) ? pose : null,
    truth: chosen.withTruth && recording.truePose(frame, truth) ? truth : null,
    seen: recording.seen[frame],
  };
}

function drawPage(now) {
  waiting = false;
  const start = performance.now();
  clock.tick(now);
  const swings = figureView.advance(now);
  const { frame } = clock;
  if (axis.show(chosen.span, frame)) stale.curves = true;
  if (stale.curves) for (const row of rows) row.draw(chosen.withTruth);
  if (recording.image || recording.pictures.length) imageView.draw(frame, chosen);
  figureView.draw(posesOf(frame), chosen);
  strip.draw(frame, axis);
  for (const row of rows) row.follow(frame);
  writeFrame(frame);
  stale.frame = stale.curves = false;
  cost.milliseconds += performance.now() - start;
  cost.draws++;
  if (clock.playing || swings) redraw();
}

// ---- Text ----------------------------------------------------------------------------------------

function writeFrame(frame) {
  const time = clockText(recording.seconds(frame));
  const refused = recording.isRefused(frame);
  const slider = byId("time");
  slider.value = frame;
  const status = refused ? `, no pose: ${recording.statusOf(frame)}` : "";
  slider.setAttribute("aria-valuetext", `frame ${frame} of ${recording.frames}, ${time}${status}`);
  byId("now").textContent = `${time}\nframe ${frame}`;
  const refusal = byId("refusal");
  refusal.hidden = !refused;
  refusal.textContent = refused ? `no pose: ${recording.statusOf(frame)}` : "";
  document.body.classList.toggle("playing", clock.playing);
  const play = byId("play");
  const name = clock.playing ? "Pause" : "Play";
  if (play.getAttribute("aria-label") !== name) play.setAttribute("aria-label", name);
  if (byId("values").open) writeJoints(frame);
}

function writeSummary() {
  const { frames, refused, fps } = recording;
  const summary = byId("summary");
  const count = frames.toLocaleString("en");
  summary.textContent =
    frames === 1 ? "1 pose" : `${count} frames, ${clockText(frames / fps)} at ${+fps.toFixed(2)} a second`;
  if (refused === 0) return;
  const button = make("button", "", `${refused.toLocaleString("en")} without a pose`);
  button.type = "button";
  button.title = "Go to the next one (R)";
  button.onclick = goToRefused;
  summary.append(", ", button);
}

const cells = recording.names.map((name, joint) => {
  const line = make("tr");
  const head = make("th");
  head.scope = "row";
  head.append(make("span", `swatch ${recording.jointSides[joint]}`), name);
  line.append(head, ...Array.from({ length: 5 }, () => make("td")));
  byId("joints").append(line);
  return [...line.querySelectorAll("td")];
});

function writeJoints(frame) {
  cells.forEach((line, joint) => jointTexts(frame, joint).forEach((text, i) => (line[i].textContent = text)));
}

/** x, y, z, the place in the image, and the confidence of a joint. */
function jointTexts(frame, joint) {
  const pose = new Float32Array(3 * (JOINT_COUNT + 1));
  const known = recording.pose(frame, pose);
  const metres = [0, 1, 2].map((i) => (known ? digits(pose[3 * joint + i], 3) : "–"));
  const point = recording.image && recording.point(frame, joint);
  if (!point) return [...metres, recording.image ? "not seen" : "–", "–"];
  const confidence = recording.confidence(frame, joint).toFixed(2);
  return [...metres, point.map((v) => digits(v, 1)).join(", "), confidence];
}

function tipText(joint) {
  const [x, y, z, place, confidence] = jointTexts(clock.frame, joint);
  const lines = [recording.names[joint], `x ${x}  y ${y}  z ${z} m`];
  if (place !== "–") lines.push(place === "not seen" ? place : `${place} px, confidence ${confidence}`);
  return lines.join("\n");
}

// ---- What the reader does ------------------------------------------------------------------------

function toggle(name, button) {
  if (button.hidden) return;
  chosen[name] = !chosen[name];
  button.setAttribute("aria-pressed", String(chosen[name]));
  redraw(true);
}

function goToRefused() {
  const frame = recording.nextRefused(clock.frame);
  if (frame >= 0) clock.step(frame - clock.frame);
}

function showView(name) {
  changeView(figureView, name);
  redraw();
}

const togglePlay = () => (clock.playing ? clock.pause() : clock.play());

const KEYS = {
  " ": togglePlay,
  ArrowLeft: (event) => clock.step(event.shiftKey ? -10 : -1),
  ArrowRight: (event) => clock.step(event.shiftKey ? 10 : 1),
  Home: () => clock.step(-recording.frames),
  End: () => clock.step(recording.frames),
  r: goToRefused,
  n: () => toggle("names", byId("names")),
  t: () => toggle("withTruth", byId("truth")),
  1: () => showView("camera"),
  2: () => showView("side"),
  3: () => showView("back"),
  4: () => showView("above"),
  "+": () => showView("closer"),
  "=": () => showView("closer"),
  "-": () => showView("farther"),
  0: () => showView("reset"),
  "?": () => byId("keys").showModal(),
};

function pressed(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || byId("keys").open || !takeKey(event)) return;
  event.preventDefault();
  redraw();
}

/** Does what a key says; false if it is another element's. */
function takeKey(event) {
  const { target, key } = event;
  if (target === byId("figure") && turnByKey(figureView, key)) return true;
  if (target.matches("select, input") && key !== " " && !/^[a-z]$/i.test(key)) return false;
  if (target.matches("select, button, summary") && (key === " " || key === "Enter")) return false;
  if (target.matches("select")) return false;
  const action = KEYS[key.length === 1 ? key.toLowerCase() : key];
  action?.(event);
  return Boolean(action);
}

/** Shows a joint's name and values while the pointer is over it. */
function hoverJoints(canvas, view) {
  const tip = canvas.parentElement.querySelector(".tip");
  const leave = () => {
    if (chosen.hovered < 0) return;
    chosen.hovered = -1;
    showTip(tip, "");
    redraw();
  };
  canvas.addEventListener("pointerleave", leave);
  const look = (event) => {
    if (event.buttons) return leave();
    const box = canvas.getBoundingClientRect();
    const [x, y] = [event.clientX - box.left, event.clientY - box.top];
    const joint = nearest(view.points.slice(0, JOINT_COUNT), x, y, 18);
    if (joint < 0) return leave();
    chosen.hovered = joint;
    showTip(tip, tipText(joint), x, y);
    redraw();
  };
  canvas.addEventListener("pointermove", look);
  canvas.addEventListener("click", look); // of a finger, which cannot hover
}

/** Moves in time while the pointer is dragged over a plot. */
function scrub(plot) {
  const move = (event) => {
    const box = plot.getBoundingClientRect();
    clock.pause();
    clock.go(axis.frame(event.clientX - box.left, box.width));
  };
  plot.addEventListener("pointerdown", (event) => {
    plot.setPointerCapture(event.pointerId);
    move(event);
  });
  plot.addEventListener("pointermove", (event) => {
    if (event.buttons) move(event);
  });
}

function hoverStrip(slider) {
  const tip = slider.parentElement.querySelector(".tip");
  slider.addEventListener("pointerleave", () => showTip(tip, ""));
  slider.addEventListener("pointermove", (event) => {
    const box = slider.getBoundingClientRect();
    const x = event.clientX - box.left;
    const frame = strip.axis.frame(x, box.width);
    const status = recording.isRefused(frame) ? `, no pose: ${recording.statusOf(frame)}` : "";
    showTip(tip, `frame ${frame}, ${clockText(recording.seconds(frame))}${status}`, x - 14, -14);
  });
}

// ---- Start ---------------------------------------------------------------------------------------

function fillSpans() {
  const select = byId("span");
  const length = recording.frames / recording.fps;
  for (const [seconds, text] of [[0, "all"], [60, "1 min"], [10, "10 s"], [3, "3 s"]])
    if (seconds === 0 || seconds < 0.7 * length) {
      const option = make("option", "", text);
      option.value = Math.round(seconds * recording.fps);
      select.append(option);
    }
  byId("span-choice").hidden = select.options.length < 2;
  select.onchange = () => {
    chosen.span = Number(select.value);
    redraw(true);
  };
}

function fillLegend() {
  for (const side of ["right", "left", "trunk"])
    byId("legend").append(make("li", side, recording.sideNames[side]));
  if (recording.hasUnseen()) byId("legend").append(make("li", "unseen", "not seen"));
  if (recording.truth) byId("legend").append(make("li", "truth", "truth"));
}

function start() {
  byId("time").max = recording.frames - 1;
  document.body.classList.toggle("single", recording.frames === 1);
  byId("truth").hidden = recording.truth === null;
  const panel = byId("image-panel");
  panel.hidden = !recording.image && recording.pictures.length === 0;
  panel.classList.toggle("on-photo", recording.pictures.length > 0);
  panel.style.setProperty("--aspect", imageView.aspect);
  byId("curves").append(...rows.map((row) => row.element));
  writeSummary();
  fillLegend();
  fillSpans();

  byId("play").onclick = togglePlay;
  byId("back").onclick = () => clock.step(-1);
  byId("forward").onclick = () => clock.step(1);
  byId("time").oninput = (event) => {
    clock.pause();
    clock.go(Number(event.target.value));
  };
  byId("speed").onchange = (event) => (clock.speed = Number(event.target.value));
  byId("names").onclick = (event) => toggle("names", event.target);
  byId("truth").onclick = (event) => toggle("withTruth", event.target);
  byId("help").onclick = () => byId("keys").showModal();
  byId("values").ontoggle = () => redraw();
  for (const button of document.querySelectorAll("[data-view]"))
    button.onclick = () => showView(button.dataset.view);
  document.addEventListener("keydown", pressed);
  followPointers(byId("figure"), figureView, () => redraw());
  hoverJoints(byId("figure"), figureView);
  hoverJoints(byId("image"), imageView);
  for (const row of rows) scrub(row.plot);
  hoverStrip(byId("time"));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColours();
    redraw(true);
  });
  const asked = /^#frame=(\d+)$/.exec(location.hash);
  if (asked) clock.go(Number(asked[1]));
  redraw(true);
}

start();

/* For tests, and for scripts of one's own: what the page shows. */
window.edmliftView = Object.freeze({
  state: () => ({
    frame: clock.frame, playing: clock.playing, speed: clock.speed, status: recording.statusOf(clock.frame),
    ...figureView.view, names: chosen.names, truth: chosen.withTruth, hovered: chosen.hovered,
    milliseconds: cost.draws ? cost.milliseconds / cost.draws : 0, draws: cost.draws,
  }),
  points: () => ({ image: imageView.points, figure: figureView.points }),
  pose: (frame) => {
    const pose = new Float32Array(3 * (JOINT_COUNT + 1));
    return recording.pose(frame, pose) ? Array.from(pose.slice(0, 3 * JOINT_COUNT)) : null;
  },
  go: (frame) => clock.go(frame),
  changeView: showView,
});
