/* The numbers beside the figure: quality, times, angles. */

import { ANGLES } from "./lift/index.js";
import { digits, inWords } from "./view/joints.js";

const WORDS = [ // from which quality on; docs/body.md says how well it holds
  [0.9, "good"],
  [0.8, "fair"],
  [0.5, "doubtful"],
  [0, "poor"],
];
const SIDES = ["right", "left"];
const BETWEEN = 150; // milliseconds between two changes of the numbers: faster ones cannot be read

const byId = (id) => document.getElementById(id);

export class Readout {
  constructor() {
    this.written = -Infinity;
    this.later = 0;
    this.cells = makeRows(byId("angles"));
  }

  /** Shows numbers soon.
   *   values  { quality, angles: by name, or null, lift, detector, rate }: NaN where there is none */
  show(values) {
    this.values = values;
    if (this.later) return;
    const wait = Math.max(0, this.written + BETWEEN - performance.now());
    this.later = setTimeout(() => this.write(), wait);
  }

  write() {
    this.later = 0;
    this.written = performance.now();
    const { quality, angles, lift, detector, rate } = this.values;
    writeQuality(quality);
    byId("lift-ms").textContent = millisecondsText(lift);
    byId("detector-ms").textContent = millisecondsText(detector);
    byId("rate").textContent = Number.isNaN(rate) ? "–" : `${digits(rate, rate < 10 ? 1 : 0)}/s`;
    for (const [name, cell] of this.cells) {
      const value = angles?.[name] ?? NaN;
      cell.textContent = Number.isNaN(value) ? "–" : `${digits(value, 0).replace("−0", "0")}°`;
    }
  }
}

function writeQuality(quality) {
  const known = !Number.isNaN(quality);
  const percent = known ? Math.round(100 * quality) : 0;
  const word = known ? WORDS.find(([least]) => quality >= least)[1] : "";
  byId("quality-number").textContent = known ? `${percent} %` : "–";
  byId("quality-word").textContent = word;
  const meter = byId("quality");
  meter.setAttribute("aria-valuenow", percent);
  meter.setAttribute("aria-valuetext", known ? `${percent} percent, ${word}` : "no pose");
  meter.dataset.word = word;
  meter.firstElementChild.style.width = `${percent}%`;
}

function millisecondsText(milliseconds) {
  if (Number.isNaN(milliseconds)) return "–";
  return `${digits(milliseconds, milliseconds < 1 ? 3 : milliseconds < 10 ? 1 : 0)} ms`;
}

/** A row for each angle; those of right and left share one.  Gives the cells by the angles' names. */
function makeRows(body) {
  const cells = new Map();
  const add = (title, names) => {
    const row = body.insertRow();
    const head = document.createElement("th");
    head.scope = "row";
    head.textContent = title;
    row.append(head);
    for (const name of names) {
      const cell = row.insertCell();
      cell.colSpan = SIDES.length / names.length;
      cells.set(name, cell);
    }
  };
  for (const name of ANGLES) {
    const [side, ...rest] = name.split("_");
    const title = rest.join("_");
    if (!SIDES.includes(side)) add(inWords(name), [name]);
    else if (!cells.has(name)) add(inWords(title), SIDES.map((other) => `${other}_${title}`));
  }
  return cells;
}
