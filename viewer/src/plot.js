// Force on the hand against time. Where there are more ticks than points, each point is the range of its ticks.

const MARGIN = { right: 12, top: 8, bottom: 34 };
const FONT = '12px "DejaVu Sans", system-ui, sans-serif';
const TITLE = 24; // of the axis of force, its room
const FORCE = "#d55e00";
const GREY = "#5a5f66";
const MODE_NAMES = ["push", "pull", "wet", "dry"];
const MODE_BANDS = ["#ffffff", "#efe7f5", "#dceefa", "#fbf1d5"];

/** Round steps 1, 2, 5 × 10ⁿ, about `wanted` of them up to `top`. */
export function roundTicks(top, wanted) {
  const raw = top / wanted;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5].find((factor) => factor * power >= raw) ?? 10);
  return Array.from({ length: Math.floor(top / step + 1e-9) + 1 }, (_, i) => +(i * step).toPrecision(12));
}

export class ForcePlot {
  /** `goTo` is called with a time [s] where the plot is clicked or dragged. */
  constructor(canvas, result, goTo) {
    this.canvas = canvas;
    this.result = result;
    this.time = 0;
    this.end = result.duration_s || 1;
    this.top = 1.05 * (result.peak_force_N || 1);
    this.left = this.findLeft();
    const pick = (event) => event.buttons & 1 && goTo(this.timeAt(event.offsetX));
    canvas.addEventListener("pointerdown", (event) => { canvas.setPointerCapture(event.pointerId); pick(event); });
    canvas.addEventListener("pointermove", pick);
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  /** Where the axis of force stands: right of its title and of its widest number. */
  findLeft() {
    const pen = this.canvas.getContext("2d");
    pen.font = FONT;
    return TITLE + Math.max(...roundTicks(this.top, 4).map((force) => pen.measureText(`${force}`).width)) + 6;
  }

  get width() { return this.canvas.clientWidth - this.left - MARGIN.right; }
  get height() { return this.canvas.clientHeight - MARGIN.top - MARGIN.bottom; }
  x(time) { return this.left + (time / this.end) * this.width; }
  y(force) { return MARGIN.top + (1 - force / this.top) * this.height; }
  timeAt(x) { return Math.min(Math.max((x - this.left) / this.width, 0), 1) * this.end; }

  resize() {
    const scale = window.devicePixelRatio;
    this.canvas.width = Math.round(this.canvas.clientWidth * scale);
    this.canvas.height = Math.round(this.canvas.clientHeight * scale);
    this.curves = this.drawCurves(scale);
    this.show(this.time);
  }

  /** Everything but the cursor, once for all frames. */
  drawCurves(scale) {
    const layer = document.createElement("canvas");
    layer.width = this.canvas.width;
    layer.height = this.canvas.height;
    const pen = layer.getContext("2d");
    pen.scale(scale, scale);
    pen.font = FONT;
    this.drawModes(pen);
    this.drawAxes(pen);
    this.drawErrorBar(pen);
    this.drawForce(pen);
    return layer;
  }

  drawModes(pen) {
    const { force_time: time, force_mode: mode } = this.result.arrays;
    for (let i = 0, begin = 0; i < mode.length; ++i) {
      if (i + 1 < mode.length && mode[i + 1] === mode[begin]) continue;
      const end = i + 1 < mode.length ? time[i + 1] : this.end;
      pen.fillStyle = MODE_BANDS[mode[begin]];
      pen.fillRect(this.x(time[begin]), MARGIN.top, this.x(end) - this.x(time[begin]), this.height);
      pen.fillStyle = GREY;
      const name = MODE_NAMES[mode[begin]];
      const room = this.x(end) - this.x(time[begin]) - 8;
      if (room > pen.measureText(name).width) pen.fillText(name, this.x(time[begin]) + 4, MARGIN.top + 12);
      begin = i + 1;
    }
  }

  drawAxes(pen) {
    pen.strokeStyle = "#e4e6e9";
    pen.fillStyle = "#22262b";
    pen.textAlign = "center";
    for (const time of roundTicks(this.end, 10)) {
      pen.strokeRect(this.x(time), MARGIN.top, 0, this.height);
      pen.fillText(`${time}`, this.x(time), MARGIN.top + this.height + 15);
    }
    pen.fillText("time [s]", this.left + this.width / 2, MARGIN.top + this.height + 30);
    pen.textAlign = "right";
    for (const force of roundTicks(this.top, 4)) {
      pen.strokeRect(this.left, this.y(force), this.width, 0);
      pen.fillText(`${force}`, this.left - 6, this.y(force) + 4);
    }
    pen.save();
    pen.translate(12, MARGIN.top + this.height / 2);
    pen.rotate(-Math.PI / 2);
    pen.textAlign = "center";
    pen.fillText("force on the hand [N]", 0, 0);
    pen.restore();
  }

  /** Where the force should be, by what the run has estimated. */
  drawErrorBar(pen) {
    const { force_time: time, error_low: low, error_high: high } = this.result.arrays;
    if (!low) return;
    pen.beginPath();
    for (let i = 0; i < time.length; ++i) pen.lineTo(this.x(time[i]), this.y(high[i]));
    for (let i = time.length - 1; i >= 0; --i) pen.lineTo(this.x(time[i]), this.y(low[i]));
    pen.closePath();
    pen.globalAlpha = 0.22;
    pen.fillStyle = FORCE;
    pen.fill();
    pen.globalAlpha = 1;
  }

  drawForce(pen) {
    const { force_time: time, force_low: low, force_high: high } = this.result.arrays;
    pen.beginPath();
    for (let i = 0; i < time.length; ++i) {
      pen.lineTo(this.x(time[i]), this.y(low[i]));
      pen.lineTo(this.x(time[i]), this.y(high[i]));
    }
    pen.strokeStyle = FORCE;
    pen.lineWidth = 1.3;
    pen.lineJoin = "round";
    pen.stroke();
  }

  /** Draws with the cursor at `time` [s]. */
  show(time) {
    this.time = time;
    const pen = this.canvas.getContext("2d");
    pen.clearRect(0, 0, this.canvas.width, this.canvas.height);
    pen.drawImage(this.curves, 0, 0);
    const scale = window.devicePixelRatio;
    pen.fillStyle = "#0072b2";
    pen.fillRect((this.x(time) - 1) * scale, MARGIN.top * scale, 2 * scale, this.height * scale);
  }
}
