// What argil wrote into the page: a description (JSON) and one deflated block of numbers, in base64.

const VIEWS = { float32: Float32Array, uint32: Uint32Array, uint16: Uint16Array, uint8: Uint8Array };

async function inflate(base64) {
  if (typeof DecompressionStream === "undefined")
    throw new Error("this browser cannot unpack the data; take one of 2023 or newer");
  const packed = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Response(stream).arrayBuffer();
}

/** Each frame but the first is kept as what changed since the one before, modulo the range of the numbers. */
function undoDifferences(values, perFrame) {
  for (let i = perFrame; i < values.length; ++i) values[i] += values[i - perFrame];
}

/** The whole result: the description, with its sections as typed arrays in `arrays`. */
export async function readResult() {
  const result = JSON.parse(document.getElementById("argil-about").textContent);
  const block = document.getElementById("argil-data");
  const buffer = await inflate(block.textContent.trim());
  block.remove();
  result.arrays = {};
  for (const { name, type, offset, length } of result.sections)
    result.arrays[name] = new VIEWS[type](buffer, offset, length);
  const frames = result.frames.length;
  for (const name of ["position", ...result.fields.map((field) => field.name)]) {
    const values = result.arrays[name];
    undoDifferences(values, values.length / frames);
  }
  return result;
}

/** Positions [m] of a frame into `out` (x y z a vertex). */
export function positionsOf(result, frame, out) {
  const { low, step } = result.grid;
  const values = result.arrays.position;
  const start = frame * out.length;
  for (let i = 0; i < out.length; ++i) out[i] = low[i % 3] + step * values[start + i];
}

/** The field in its unit, one number a vertex. Displacement is measured from the body at rest. */
export function valuesOf(result, field, frame, count) {
  const values = new Float32Array(count);
  if (field.name === "displacement") {
    const { position, rest } = result.arrays;
    const scale = result.grid.step * field.scale;
    const start = 3 * count * frame;
    const moved = (i) => position[start + i] - rest[i];
    for (let v = 0; v < count; ++v) values[v] = scale * Math.hypot(moved(3 * v), moved(3 * v + 1), moved(3 * v + 2));
    return values;
  }
  const bytes = result.arrays[field.name];
  for (let v = 0, b = count * frame; v < count; ++v, ++b) values[v] = (field.top * bytes[b]) / 255;
  return values;
}

/** The axis that points up: y where the vertices that never move are the body's foot in y and not in z, else z. */
export function findUp(result) {
  const { position } = result.arrays;
  const { num_vertices: count, frames } = result;
  const foot = 0.3; // of the body's height, at most
  const body = [0, 1, 2].map(() => ({ low: Infinity, high: -Infinity }));
  const held = [0, 1, 2].map(() => ({ high: -Infinity }));
  for (let v = 0; v < count; ++v) {
    const isStill = frames.every((_, frame) => [0, 1, 2].every((k) => position[3 * (frame * count + v) + k] === position[3 * v + k]));
    for (let k = 0; k < 3; ++k) {
      const x = position[3 * v + k];
      body[k].low = Math.min(body[k].low, x);
      body[k].high = Math.max(body[k].high, x);
      if (isStill) held[k].high = Math.max(held[k].high, x);
    }
  }
  const isFoot = (k) => held[k].high - body[k].low < foot * (body[k].high - body[k].low);
  return Number.isFinite(held[0].high) && isFoot(1) && !isFoot(2) ? "y" : "z";
}
