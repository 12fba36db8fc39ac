// Puts the parts together: one state (the frame that is shown), and everything that follows it.

import { colourValues, drawLegend, rampTable } from "./colours.js";
import { findUp, positionsOf, readResult, valuesOf } from "./data.js";
import { ForcePlot } from "./plot.js";
import { View } from "./scene.js";

const $ = (id) => document.getElementById(id);

function fillList(list, texts) {
  list.replaceChildren(...texts.map((text) => Object.assign(document.createElement("li"), { textContent: text })));
}

function say(words) {
  $("trouble").hidden = false;
  $("trouble").textContent = words;
}

/** The frame of the largest force; the first without any. */
function frameOfPeak(result) {
  const forces = result.frames.map((frame) => Math.hypot(...frame.force_N));
  return forces.indexOf(Math.max(...forces));
}

class Page {
  constructor(result) {
    this.result = result;
    this.frame = frameOfPeak(result);
    this.isUntouched = true; // it opens there, and plays from the start
    this.playingSince = null;
    this.describe();
    $("up").value = findUp(result);
    try {
      this.view = new View($("scene"), result);
      this.view.setUp($("up").value);
    } catch (error) {
      say(`The body is not drawn: ${error.message}. The browser needs WebGL.`);
    }
    this.plot = new ForcePlot($("plot"), result, (time) => { this.pause(); this.isUntouched = false; this.goTo(time); });
    this.listen();
    this.chooseField();
  }

  describe() {
    const { result } = this;
    document.title = `${result.file} – argil`;
    $("title").textContent = result.file;
    $("summary").textContent = result.summary;
    fillList($("notes"), result.notes);
    $("field").replaceChildren(...result.fields_shown.map((field) => new Option(field.title, field.name)));
    $("slider").max = result.frames.length - 1;
  }

  listen() {
    $("slider").addEventListener("input", () => { this.pause(); this.isUntouched = false; this.show($("slider").valueAsNumber); });
    $("field").addEventListener("change", () => this.chooseField());
    $("show-tool").addEventListener("change", () => this.show(this.frame));
    $("up").addEventListener("change", () => this.view?.setUp($("up").value));
    $("reset").addEventListener("click", () => this.view?.reset());
    $("speed").addEventListener("change", () => { if (this.playingSince) this.play(); });
    $("play").addEventListener("click", () => (this.playingSince ? this.pause() : this.play()));
  }

  chooseField() {
    this.field = this.result.fields_shown.find((field) => field.name === $("field").value);
    this.table = rampTable(this.field.ramp);
    drawLegend($("legend-bar"), this.table);
    $("legend-title").textContent = `${this.field.title} [${this.field.unit}]`;
    fillList($("legend-ticks"), [1, 0.75, 0.5, 0.25, 0].map((part) => +(part * this.field.top).toPrecision(3)));
    this.show(this.frame);
  }

  /** The last frame at or before `time` [s]. */
  frameAt(time) {
    const { frames } = this.result;
    const after = frames.findIndex((frame) => frame.time_s > time + 1e-9);
    return after < 0 ? frames.length - 1 : Math.max(after - 1, 0);
  }
  goTo(time) { this.show(this.frameAt(time)); }

  show(number) {
    const { result, view } = this;
    const frame = result.frames[number];
    this.frame = number;
    $("slider").value = number;
    document.body.dataset.frame = number;
    $("time").textContent = `${frame.time_s.toFixed(3)} s · frame ${number + 1} of ${result.frames.length}`;
    $("slider").setAttribute("aria-valuetext", `${frame.time_s.toFixed(3)} seconds`);
    const force = Math.hypot(...frame.force_N);
    $("readout").textContent = frame.has_tool ? `${frame.mode}, force ${force.toFixed(3)} N` : "no tool";
    this.plot.show(frame.time_s);
    if (!view) return;
    positionsOf(result, number, view.positions);
    const values = valuesOf(result, this.field, number, result.num_vertices);
    colourValues(values, this.field.top, this.table, view.colours);
    view.updateBody();
    view.placeTool(frame, $("show-tool").checked);
    view.draw();
  }

  play() {
    const { frames } = this.result;
    const start = this.isUntouched || this.frame === frames.length - 1 ? 0 : this.frame;
    this.isUntouched = false;
    this.playingSince = { wall: performance.now(), time: frames[start].time_s };
    $("play").textContent = "❚❚";
    $("play").setAttribute("aria-label", "pause");
    requestAnimationFrame((now) => this.advance(now));
  }

  advance(now) {
    if (!this.playingSince) return;
    const { wall, time } = this.playingSince;
    const at = time + (Math.max(now - wall, 0) / 1000) * Number($("speed").value);
    const number = this.frameAt(at);
    if (number !== this.frame) this.show(number);
    if (number === this.result.frames.length - 1) this.pause();
    else requestAnimationFrame((next) => this.advance(next));
  }

  pause() {
    this.playingSince = null;
    $("play").textContent = "▶";
    $("play").setAttribute("aria-label", "play");
  }
}

/** What can be chosen: the fields that were written and the displacement, which follows from the positions. */
function listFields(result) {
  const displacement = { name: "displacement", title: "displacement", unit: "mm", scale: 1e3, ramp: "strained" };
  let top = 0;
  result.frames.forEach((_, frame) => {
    for (const value of valuesOf(result, displacement, frame, result.num_vertices)) if (value > top) top = value;
  });
  displacement.top = top || 1;
  const [first, ...others] = result.fields;
  result.fields_shown = [first, displacement, ...others];
}

readResult().then((result) => {
  listFields(result);
  window.argil = new Page(result); // for the curious, and for tests
}).catch((error) => say(`The page cannot be shown: ${error.message}`));
