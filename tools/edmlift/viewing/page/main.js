/* The page: its parts, what the reader does with them, and when they are drawn. */

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
const figureView = new FigureView(byId("figure"), recording, () => redraw());
const axis = new TimeAxis(recording.frames);
const rows = recording.curves.map((row) => new CurveRow(row, axis, () => redraw(true)));
const strip = new Strip(byId("strip"), recording, () => redraw());
const cost = { milliseconds: 0, draws: 0 };

function drawPage(now) {
  waiting = false;
  const start = performance.now();
  clock.tick(now);
  const swings = figureView.advance(now);
  const { frame } = clock;
  if (axis.show(chosen.span, frame)) stale.curves = true;
  if (stale.curves) for (const row of rows) row.draw(chosen.withTruth);
  if (recording.image || recording.pictures.length) imageView.draw(frame, chosen);
  figureView.draw(frame, chosen);
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

function changeView(name) {
  if (name === "closer") figureView.zoom(1.25);
  else if (name === "farther") figureView.zoom(1 / 1.25);
  else figureView.go(name, performance.now());
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
  1: () => changeView("camera"),
  2: () => changeView("side"),
  3: () => changeView("back"),
  4: () => changeView("above"),
  "+": () => changeView("closer"),
  "=": () => changeView("closer"),
  "-": () => changeView("farther"),
  0: () => changeView("reset"),
  "?": () => byId("keys").showModal(),
};
const FIGURE_KEYS = {
  ArrowLeft: () => figureView.turn(6, 0), // as if what is near were pushed that way
  ArrowRight: () => figureView.turn(-6, 0),
  ArrowUp: () => figureView.turn(0, -5),
  ArrowDown: () => figureView.turn(0, 5),
};

function pressed(event) {
  if (event.ctrlKey || event.metaKey || event.altKey || byId("keys").open) return;
  const { target, key } = event;
  const own = FIGURE_KEYS[key];
  if (target === byId("figure") && own) own();
  else if (target.matches("select, input") && key !== " " && !/^[a-z]$/i.test(key)) return;
  else if (target.matches("select, button, summary") && (key === " " || key === "Enter")) return;
  else if (target.matches("select")) return;
  else {
    const action = KEYS[key.length === 1 ? key.toLowerCase() : key];
    if (!action) return;
    action(event);
  }
  event.preventDefault();
  redraw();
}

/** Turns and zooms the figure by one or two pointers. */
function followPointers(canvas) {
  const pointers = new Map();
  let apart = 0;
  const spread = () => {
    const [a, b] = [...pointers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y);
  };
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (pointers.size === 2) apart = spread();
    canvas.classList.add("dragged");
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    if (pointers.size === 1) figureView.turn(-0.5 * (event.clientX - before.x), 0.4 * (event.clientY - before.y));
    else if (pointers.size === 2) {
      const now = spread();
      if (apart > 0) figureView.zoom(now / apart);
      apart = now;
    }
    redraw();
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, (event) => {
      pointers.delete(event.pointerId);
      canvas.classList.toggle("dragged", pointers.size > 0);
    });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    const across = event.shiftKey ? event.deltaX || event.deltaY : event.deltaX;
    if (Math.abs(across) > 0 && (event.shiftKey || Math.abs(across) > Math.abs(event.deltaY)))
      figureView.turn(0.15 * across, 0);
    else figureView.zoom(Math.exp(-0.0015 * event.deltaY));
    redraw();
  }, { passive: false });
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
    button.onclick = () => changeView(button.dataset.view);
  document.addEventListener("keydown", pressed);
  followPointers(byId("figure"));
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
  changeView,
});
