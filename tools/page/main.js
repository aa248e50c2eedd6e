/* The page: its parts, what the reader does with them, and when they are drawn. */

import { BODY } from "./body.js";
import { graphics, nameOf, needsWebgl, preferred, sizeOf, startDetector } from "./detectors/detectors.js";
import { DragBoard } from "./dragging.js";
import { Footage, Problem, listCameras } from "./footage.js";
import { Lifting } from "./lifting.js";
import { PictureView } from "./picture.js";
import { Readout } from "./readout.js";
import { SAMPLES } from "./samples.js";
import { FigureView, roomOf } from "./view/figure.js";
import { JOINT_COUNT, addMiddle, digits, inWords } from "./view/joints.js";
import { readColours } from "./view/paint.js";
import { changeView, followPointers, turnByKey } from "./view/turning.js";
import { Watching } from "./watching.js";

const ROOM = { height: 1.75, radius: 0.55 }; // metres that a figure takes at least
const LEVEL = [0, -1, 0];
const RESTS = 600; // milliseconds after which a joint that was moved is taken to rest
const FIGURE_KEYS = {
  1: "camera", 2: "side", 3: "above", "+": "closer", "=": "closer", "-": "farther", 0: "reset",
};

const byId = (id) => document.getElementById(id);
const source = () => document.body.dataset.source;

const lifting = new Lifting();
const readout = new Readout();
const state = {
  pose: null, // of the library, or null where nobody is seen
  detectors: {}, // what is installed, by name
  detector: null, // one that was started, with its id
  footage: null,
  watching: null,
  time: null, // of the frame that is shown, milliseconds
  mirrored: false, // is the picture a mirror image? The figure is one then, too
  asked: null, // what is waited for
};

readColours();
const pictureView = new PictureView(byId("picture"), BODY, redraw);
const figureView = new FigureView(byId("figure"), BODY, ROOM, redraw);
const board = new DragBoard(byId("joints"), pictureView, BODY.names, dragged);
const drawn = new Float32Array(3 * (JOINT_COUNT + 1)); // the pose as the figure has it

// ---- Drawing -------------------------------------------------------------------------------------

let waiting = false;

function redraw() {
  if (waiting) return;
  waiting = true;
  requestAnimationFrame(draw);
}

function draw(now) {
  waiting = false;
  const swings = figureView.advance(now);
  const names = byId("names").checked;
  pictureView.draw(names);
  byId("picture-panel").classList.toggle("on-photo", pictureView.frame !== null);
  figureView.draw({ pose: poseToDraw(), seen: seenBits() }, { names });
  if (source() === "drag") board.follow();
  if (swings) redraw();
}

/** The pose with the middle of the hips, mirrored if the picture is; null: there is none. */
function poseToDraw() {
  if (state.pose?.status !== "ok") return null;
  drawn.set(state.pose.joints);
  if (state.mirrored) for (let i = 0; i < drawn.length; i += 3) drawn[i] = -drawn[i];
  addMiddle(drawn);
  return drawn;
}

/** Steps back for a pose that needs more room than those before it. */
function makeRoom() {
  const { height, radius } = roomOf([poseToDraw()]);
  const { room } = figureView;
  figureView.room = { height: Math.max(room.height, height), radius: Math.max(room.radius, radius) };
}

const seenBits = () => (state.pose?.seen ?? []).reduce((bits, seen, joint) => bits | (seen << joint), 0);

/** Takes a pose, or null: nobody is seen. */
function showPose(pose) {
  state.pose = pose;
  const ok = pose?.status === "ok";
  if (ok) makeRoom();
  say("refusal", refusalOf(pose));
  const { watching } = state;
  readout.show({
    quality: ok ? pose.quality : NaN,
    angles: ok ? lifting.angles(pose) : null,
    lift: lifting.milliseconds,
    detector: watching?.detectorMs ?? NaN,
    rate: watching?.rate ?? NaN,
  });
  redraw();
}

/** Why there is no figure, in words; "" where there is one, or where nothing was looked at yet. */
function refusalOf(pose) {
  if (!pose) return state.watching ? "Nobody is seen." : "";
  if (pose.status === "ok") return "";
  if (pose.status !== "too_few_joints") return `No pose: ${inWords(pose.status)}.`;
  const seen = pose.seen.filter(Boolean).length;
  return `No pose: ${seen} of 14 joints are seen, and 10 are needed.`;
}

/** Shows a text, or hides its place; changes nothing where nothing changes, because it may be read aloud. */
function say(id, text) {
  const element = byId(id);
  if (element.textContent === text && element.hidden === !text) return;
  element.textContent = text;
  element.hidden = !text;
}

// ---- Joints that are dragged ---------------------------------------------------------------------

function dragged() {
  if (source() !== "drag") return;
  const { chosen } = board;
  pictureView.show(board.shown);
  byId("joint-now").textContent = chosen < 0 ? "no joint chosen" : BODY.names[chosen];
  byId("seen").disabled = chosen < 0;
  byId("seen").checked = chosen < 0 || board.seen[chosen];
  if (lifting.lifter) showPose(lifting.lift(board.keypoints));
  speak();
}

let speech = 0;

/** Says aloud what became of a joint, once it rests. */
function speak() {
  clearTimeout(speech);
  if (board.chosen < 0) return;
  speech = setTimeout(() => {
    if (!state.pose) return;
    const quality = refusalOf(state.pose) || `Quality ${Math.round(100 * state.pose.quality)} percent.`;
    byId("spoken").textContent = `${BODY.names[board.chosen]} ${board.say(board.chosen)}. ${quality}`;
  }, RESTS);
}

function startBoard(points) {
  figureView.room = ROOM;
  board.start(points);
}

// ---- Footage -------------------------------------------------------------------------------------

/** What invites to begin, before there is footage. */
function invite() {
  const ids = Object.keys(state.detectors);
  const texts = {
    camera: ["The pictures of your camera stay on this device.", "Start the camera"],
    video: ["The video stays on this device.", "Choose a video file"],
  };
  const [text, button] = texts[source()] ?? [];
  byId("invitation").hidden = !text || Boolean(state.footage);
  if (!text) return;
  byId("invitation-text").textContent = text;
  byId("start").textContent = button;
  const id = byId("detector").value;
  byId("invitation-more").textContent = id && `${nameOf(id)} finds the joints: ${sizeOf(state.detectors[id].files)}, loaded once.`;
  byId("start").hidden = ids.length === 0;
  if (ids.length === 0)
    complain("This copy of the page has no detector. tools/web installs one, unless it is told --no-detector.");
}

function begin() {
  if (source() === "camera") open("Waiting for the camera", () => Footage.camera(byId("cameras").value));
  else byId("file").click();
}

/** Opens footage, with the detector that is chosen.  what: what is waited for. */
async function open(what, makeFootage) {
  const asked = ask();
  close();
  byId("invitation").hidden = true;
  try {
    await useDetector(asked);
    if (!isAsked(asked)) return;
    progress(what, NaN);
    const footage = await makeFootage();
    if (!isAsked(asked)) return footage.close();
    state.footage = footage;
    footage.lost = () => fail(new Problem("The camera is gone. Connect it and start again."));
    await showFootage(footage);
    watch();
  } catch (error) {
    if (isAsked(asked)) fail(error);
  }
}

/** What takes a while was asked for by the reader, who may ask for something else meanwhile. */
function ask() {
  complain("");
  return (state.asked = Symbol("asked"));
}

const isAsked = (asked) => state.asked === asked;

/** Starts the chosen detector, unless it runs. */
async function useDetector(asked) {
  const id = byId("detector").value;
  if (state.detector?.id === id) return;
  state.detector?.close();
  state.detector = null;
  const report = (text, share) => isAsked(asked) && progress(text, share);
  const loading = `Loading ${nameOf(id)}`;
  report(loading, 0);
  const started = await startDetector(id, state.detectors[id], (there, wanted) => {
    const [megabytes, all] = [there, wanted].map((bytes) => Math.round(bytes / 1e6));
    if (there < wanted) report(`${loading}: ${megabytes} of ${all} MB`, there / wanted);
    else report(`Starting ${nameOf(id)}`, NaN);
  });
  if (!isAsked(asked)) return started.close();
  started.id = id;
  state.detector = started;
}

async function showFootage(footage) {
  const isCamera = footage.live;
  byId("stop").hidden = !isCamera;
  for (const id of ["play", "time", "now", "another"]) byId(id).hidden = isCamera;
  if (!isCamera) return;
  byId("mirror").checked = footage.facesUser;
  const cameras = await listCameras();
  byId("cameras").replaceChildren(
    ...cameras.map(({ label, deviceId }, i) => new Option(label || `camera ${i + 1}`, deviceId)),
  );
  byId("cameras").value = footage.device ?? "";
  byId("cameras-choice").hidden = cameras.length < 2;
}

function watch() {
  const { footage, detector } = state;
  state.watching?.stop();
  state.watching = new Watching(footage, detector, lifting, showFrame);
  state.watching.mirrored = !footage.live && byId("selfie").checked;
  state.watching.run().catch((error) => {
    state.detector = null;
    fail(new Error(`${nameOf(detector.id)} has stopped: ${error.message}`));
  });
}

function showFrame({ frame, time, pose }) {
  const { live } = state.footage;
  const isSelfie = !live && byId("selfie").checked; // the lift has turned it back, and the picture is as it came
  const mirrored = live && byId("mirror").checked;
  const place = (joint) => {
    const [x, y] = pose.keypoints.subarray(3 * joint);
    return pose.seen[joint] ? [isSelfie ? frame.width - x : x, y] : null;
  };
  const joints = pose ? BODY.names.map((_, joint) => place(joint)) : [];
  Object.assign(state, { time, mirrored: mirrored || isSelfie });
  progress(null);
  pictureView.show({ box: [0, 0, frame.width, frame.height], frame, joints, mirrored });
  showTime();
  showPose(pose);
}

function showTime() {
  const { video, live } = state.footage;
  if (live) return;
  byId("time").max = Number.isFinite(video.duration) ? video.duration : video.currentTime;
  byId("time").value = video.currentTime;
  byId("now").textContent = `${digits(video.currentTime, 1)} s`;
  byId("play").setAttribute("aria-label", video.paused ? "Play" : "Pause");
  document.body.classList.toggle("playing", !video.paused);
}

/** Closes the footage. */
function close() {
  state.watching?.stop();
  state.footage?.close();
  state.watching = state.footage = state.time = null;
  state.mirrored = false;
  for (const id of ["stop", "play", "time", "now", "another", "cameras-choice"]) byId(id).hidden = true;
}

/** Closes the footage and invites again. */
function leave() {
  state.asked = null;
  close();
  progress(null);
  pictureView.show({ box: [0, 0, 4, 3] });
  showPose(null);
  invite();
}

function fail(error) {
  leave();
  complain(error);
}

// ---- What is said --------------------------------------------------------------------------------

/** Says what is wrong: a text or an Error; "" says nothing. */
function complain(what) {
  if (what instanceof Error && !(what instanceof Problem)) console.error(what);
  say("problem", what instanceof Error ? what.message : what);
}

/** Shows how far something is, 0 to 1, NaN: not known; null hides it. */
function progress(text, share) {
  byId("progress").hidden = text === null;
  if (text === null) return;
  byId("progress-text").textContent = text;
  if (Number.isNaN(share)) byId("progress-bar").removeAttribute("value");
  else byId("progress-bar").value = share;
}

// ---- What the reader does ------------------------------------------------------------------------

function chooseSource(name) {
  document.body.dataset.source = name;
  figureView.room = ROOM;
  complain("");
  leave();
  if (name === "drag") dragged();
  else pictureView.show({ box: [0, 0, 4, 3] });
}

async function chooseModel() {
  const select = byId("model");
  try {
    await lifting.choose(select.value);
    select.dataset.chosen = select.value;
    complain("");
  } catch (error) {
    complain(`${select.value} cannot be loaded: ${error.message}`);
    if (select.dataset.chosen) select.value = select.dataset.chosen;
  }
  dragged();
}

async function chooseDetector() {
  invite();
  if (!state.footage) return;
  const asked = ask();
  state.watching?.stop();
  try {
    await useDetector(asked);
    if (isAsked(asked)) watch();
  } catch (error) {
    if (isAsked(asked)) fail(error);
  }
}

function pressed(event) {
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const view = FIGURE_KEYS[event.key];
  if (view) changeView(figureView, view);
  else if (!turnByKey(figureView, event.key)) return;
  event.preventDefault();
  redraw();
}

function playOrPause() {
  const { video } = state.footage;
  if (video.paused) video.play();
  else video.pause();
  showTime();
}

function openFile(file) {
  if (file) open(`Opening ${file.name}`, () => Footage.file(file));
}

function connect() {
  for (const radio of document.querySelectorAll("[name=source]"))
    radio.onchange = () => chooseSource(radio.value);
  byId("sample").append(...Object.keys(SAMPLES).map((name) => new Option(name)));
  byId("sample").onchange = ({ target }) => {
    startBoard(SAMPLES[target.value]);
    target.value = ""; // so that the same one can be chosen again
  };
  byId("seen").onchange = ({ target }) => board.toggle(target.checked);
  byId("start").onclick = begin;
  byId("stop").onclick = leave;
  byId("another").onclick = () => byId("file").click();
  byId("file").onchange = ({ target }) => {
    openFile(target.files[0]);
    target.value = ""; // the same file can be chosen again
  };
  byId("cameras").onchange = begin;
  byId("play").onclick = playOrPause;
  byId("time").oninput = ({ target }) => {
    state.footage.video.currentTime = target.value;
    state.watching?.cut();
    showTime();
  };
  byId("selfie").onchange = () => state.watching && watch();
  byId("mirror").onchange = () => state.watching && watch();
  byId("names").onchange = redraw;
  byId("level").onchange = ({ target }) => {
    lifting.setUp(target.checked ? LEVEL : undefined);
    dragged();
  };
  byId("model").onchange = chooseModel;
  byId("detector").onchange = chooseDetector;
  connectFigure();
  connectDrop();
}

function connectFigure() {
  followPointers(byId("figure"), figureView, redraw);
  byId("figure").onkeydown = pressed;
  for (const button of document.querySelectorAll("[data-view]"))
    button.onclick = () => {
      changeView(figureView, button.dataset.view);
      redraw();
    };
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColours();
    redraw();
  });
}

/** A file that is dropped anywhere is opened. */
function connectDrop() {
  addEventListener("dragover", (event) => event.preventDefault());
  addEventListener("drop", (event) => {
    event.preventDefault();
    const file = event.dataTransfer.files[0];
    if (!file) return;
    document.querySelector("[name=source][value=video]").checked = true;
    chooseSource("video");
    openFile(file);
  });
}

// ---- Start ---------------------------------------------------------------------------------------

async function readFiles() {
  const { version, models, detectors } = await (await fetch("files.json")).json();
  byId("version").textContent = `edmlift ${version}`;
  byId("model").append(...models.map((name) => new Option(name)));
  state.detectors = detectors;
  const ids = Object.keys(detectors);
  byId("detector").append(...ids.map((id) => new Option(nameOf(id), id)));
  if (ids.length) byId("detector").value = preferred(ids);
}

async function storePage() {
  if (!navigator.serviceWorker) return;
  try {
    await navigator.serviceWorker.register("sw.js");
    await navigator.serviceWorker.ready;
    byId("offline").hidden = false;
  } catch (error) {
    console.warn(`The page is not stored: ${error.message}`);
  }
}

async function start() {
  connect();
  startBoard(Object.values(SAMPLES)[0]);
  await readFiles();
  await chooseModel();
  storePage();
}

await start();

/* For tests, and for scripts of one's own: what the page shows. */
window.edmliftPage = Object.freeze({
  state: () => ({
    source: source(), model: lifting.lifter?.model, detector: state.detector?.id ?? null, ...figureView.view,
    status: state.pose?.status ?? null, time: state.time, quality: state.pose?.quality ?? null, chosen: board.chosen,
    liftMs: lifting.milliseconds, detectorMs: state.watching?.detectorMs ?? null, graphics: graphics(),
  }),
  pose: () => state.pose && { ...state.pose, joints: [...state.pose.joints], keypoints: [...state.pose.keypoints] },
  joints: () => board.keypoints,
  places: () => ({ picture: pictureView.places, figure: figureView.points }),
});
