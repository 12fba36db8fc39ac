// Ramps whose lightness falls all the way, so that their order survives any colour blindness and a grey print.

const CLAY = [204, 143, 110];
const RAMPS = {
  wet: [CLAY, [133, 143, 158], [33, 102, 168], [10, 38, 102]],
  strained: [CLAY, [184, 84, 92], [102, 31, 102], [33, 10, 61]],
};
const STEPS = 256;

/** 256 sRGB colours of a ramp, three bytes each. */
export function rampTable(name) {
  const stops = RAMPS[name];
  const table = new Uint8ClampedArray(3 * STEPS);
  for (let i = 0; i < STEPS; ++i) {
    const at = (i / (STEPS - 1)) * (stops.length - 1);
    const left = Math.min(Math.floor(at), stops.length - 2);
    for (let k = 0; k < 3; ++k)
      table[3 * i + k] = stops[left][k] + (at - left) * (stops[left + 1][k] - stops[left][k]);
  }
  return table;
}

const toLinear = (byte) => (byte <= 10.31475 ? byte / 3294.6 : ((byte / 255 + 0.055) / 1.055) ** 2.4);

/** Colours of values from 0 to `top`, in the linear light that three.js calculates with, into `out`. */
export function colourValues(values, top, table, out) {
  const linear = Float32Array.from(table, toLinear);
  for (let v = 0; v < values.length; ++v) {
    const step = Math.min(Math.max(Math.round(((STEPS - 1) * values[v]) / top), 0), STEPS - 1);
    out.set(linear.subarray(3 * step, 3 * step + 3), 3 * v);
  }
}

/** The bar beside the scene: 0 at its foot, `top` at its head. */
export function drawLegend(canvas, table) {
  const pen = canvas.getContext("2d");
  for (let y = 0; y < canvas.height; ++y) {
    const step = Math.round((1 - y / (canvas.height - 1)) * (STEPS - 1));
    pen.fillStyle = `rgb(${table.subarray(3 * step, 3 * step + 3).join(" ")})`;
    pen.fillRect(0, y, canvas.width, 1);
  }
}
