// The body, the tool and the force, drawn by three.js. Lengths are metres.

import {
  Box3, BufferAttribute, BufferGeometry, Color, ConeGeometry, CylinderGeometry, DirectionalLight, DoubleSide, Group,
  HemisphereLight, Line, LineBasicMaterial, Mesh, MeshStandardMaterial, PerspectiveCamera, Quaternion, Scene, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";

const OPENING_DEGREES = 30;
const ROOM = 1.06; // around what is fitted
const PEAK_ARROW = 0.33; // length of the largest force over the size of the body
const UP = new Vector3(0, 1, 0); // of three.js' own cylinders

function makeBody(indices, numVertices) {
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(indices, 1));
  geometry.setAttribute("position", new BufferAttribute(new Float32Array(3 * numVertices), 3));
  geometry.setAttribute("color", new BufferAttribute(new Float32Array(3 * numVertices), 3));
  return new Mesh(geometry, new MeshStandardMaterial({ vertexColors: true, roughness: 0.75, side: DoubleSide }));
}

function makeTool(vertices, indices) {
  const geometry = new BufferGeometry();
  geometry.setIndex(new BufferAttribute(indices, 1));
  geometry.setAttribute("position", new BufferAttribute(vertices, 3));
  geometry.computeVertexNormals();
  return new Mesh(geometry, new MeshStandardMaterial({
    color: 0xd7e0ea, roughness: 0.3, transparent: true, opacity: 0.45, depthWrite: false,
  }));
}

/** Where the hand's point goes over the whole motion, faintly, also behind the body. */
function makePath(points) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(points, 3));
  const path = new Line(geometry, new LineBasicMaterial({
    color: 0x2f5d8c, transparent: true, opacity: 0.35, depthTest: false, depthWrite: false,
  }));
  path.frustumCulled = false;
  return path;
}

/** An arrow of length 1 along +y, from the origin. */
function makeArrow() {
  const material = new MeshStandardMaterial({ color: 0x191a1f, roughness: 0.6 });
  const shaft = new Mesh(new CylinderGeometry(0.03, 0.03, 0.68, 20), material);
  shaft.position.y = 0.34;
  const head = new Mesh(new ConeGeometry(0.085, 0.32, 28), material);
  head.position.y = 0.84;
  return new Group().add(shaft, head);
}

/** Extent of all frames: the grid that the positions were rounded to. */
function extentOf(result) {
  const low = new Vector3(...result.grid.low);
  const high = new Vector3(...result.grid.high);
  const box = high.clone().sub(low);
  return { middle: low.add(high).multiplyScalar(0.5), box, size: box.length() };
}

/** The tool's extent, the eight corners of its box where it is at rest; none where there is no tool. */
function toolCorners(vertices) {
  if (vertices.length === 0) return [];
  const box = new Box3().setFromArray(vertices);
  const { min, max } = box;
  return [min.x, max.x].flatMap((x) => [min.y, max.y].flatMap((y) => [min.z, max.z].map((z) => new Vector3(x, y, z))));
}

/** What the opening picture holds: the body in all frames, the tool where it is not far from it, and the force's arrow. */
function pointsToShow(result, { middle, box, size }) {
  const points = [];
  for (const x of [-0.5, 0.5]) for (const y of [-0.5, 0.5]) for (const z of [-0.5, 0.5])
    points.push(box.clone().multiply(new Vector3(x, y, z)).add(middle));
  const corners = toolCorners(result.arrays.tool_vertices);
  for (const frame of result.frames) {
    const place = new Vector3(...frame.tool_position_m);
    if (!frame.has_tool || place.distanceTo(middle) > size) continue;
    const turn = new Quaternion(...frame.tool_orientation);
    for (const corner of corners) points.push(corner.clone().applyQuaternion(turn).add(place));
    if (!(result.peak_force_N > 0)) continue;
    for (const way of frame.mode === "pull" ? [1, -1] : [1])
      points.push(place.clone().addScaledVector(new Vector3(...frame.force_N), (way * PEAK_ARROW * size) / result.peak_force_N));
  }
  return points;
}

export class View {
  /** Throws where the browser has no WebGL. */
  constructor(host, result) {
    this.host = host;
    this.renderer = new WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, 2));
    host.append(this.renderer.domElement);
    this.extent = extentOf(result);
    this.points = pointsToShow(result, this.extent);
    this.target = new Box3().setFromPoints(this.points).getCenter(new Vector3());
    this.peak = result.peak_force_N;
    const { arrays } = result;
    this.body = makeBody(arrays.triangles, result.num_vertices);
    this.tool = makeTool(arrays.tool_vertices, arrays.tool_triangles);
    this.arrow = makeArrow();
    this.path = makePath(arrays.tool_path);
    this.scene = new Scene();
    this.scene.background = new Color(0xf6f7f8);
    this.scene.add(this.body, this.tool, this.arrow, this.path);
    this.addCamera(result);
    new ResizeObserver(() => this.resize()).observe(host);
    this.resize();
  }

  addCamera(result) {
    const { size } = this.extent;
    this.camera = new PerspectiveCamera(OPENING_DEGREES, 1, size / 50, size * 20);
    this.scene.add(this.camera, new HemisphereLight(0xffffff, 0xb9a79c, 1.5));
    for (const [x, y, z, brightness] of [[-0.6, 0.8, 1.0, 2.0], [1.0, 0.1, 0.6, 0.7]]) {
      const light = new DirectionalLight(0xffffff, brightness); // moves with the eye
      light.position.set(x * size, y * size, z * size);
      light.target = this.body;
      this.camera.add(light);
    }
    this.touched = result.touched;
    this.setUp("z");
  }

  /** Turns the picture so that an axis, "x", "y" or "z", points up, seen as at first. */
  setUp(axis) {
    this.camera.up.set(0, 0, 0)[axis] = 1;
    this.away = this.findDirection(axis);
    this.controls?.dispose(); // it keeps the camera's up of its start
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => { this.isFitted = false; });
    this.reset();
  }

  /** Towards the eye: 30 degrees off the side of the body's box that the tool is nearest to, and from above. */
  findDirection(axis) {
    const { middle, box } = this.extent;
    const [ahead, aside] = { x: "yz", y: "zx", z: "xy" }[axis];
    const part = (k, name) => (this.touched[k] - middle[name]) / box[name];
    const [first, second] = [ahead, aside].map((name) => part("xyz".indexOf(name), name));
    const away = new Vector3();
    away[axis] = 0.36;
    [away[ahead], away[aside]] = Math.abs(first) > Math.abs(second)
      ? [first > 0 ? 0.92 : -0.92, -0.5] : [0.5, second > 0 ? 0.92 : -0.92];
    return away.normalize();
  }

  /** How far from the target every point is inside the picture, whatever its aspect [m]. */
  findDistance() {
    const right = this.camera.up.clone().cross(this.away).normalize();
    const up = this.away.clone().cross(right);
    const rise = Math.tan((OPENING_DEGREES * Math.PI) / 360);
    const point = new Vector3();
    let distance = 0;
    for (const place of this.points) {
      point.copy(place).sub(this.target);
      const aside = Math.max(Math.abs(point.dot(right)) / this.camera.aspect, Math.abs(point.dot(up)));
      distance = Math.max(distance, point.dot(this.away) + (ROOM * aside) / rise);
    }
    return distance;
  }

  reset() {
    this.isFitted = true;
    this.camera.position.copy(this.target).addScaledVector(this.away, this.findDistance());
    this.controls.target.copy(this.target);
    this.controls.update();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.host;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (this.isFitted) this.reset();
    this.draw();
  }

  get positions() { return this.body.geometry.attributes.position.array; }
  get colours() { return this.body.geometry.attributes.color.array; }

  /** After new numbers were put into `positions` and `colours`. */
  updateBody() {
    const { geometry } = this.body;
    geometry.attributes.position.needsUpdate = true;
    geometry.attributes.color.needsUpdate = true;
    geometry.computeVertexNormals();
    geometry.computeBoundingSphere();
  }

  /** Of the body where it is nearest to a place. */
  outwardNear(place) {
    const { position, normal } = this.body.geometry.attributes;
    const at = new Vector3();
    let nearest = 0;
    let least = Infinity;
    for (let i = 0; i < position.count; ++i) {
      const squared = at.fromBufferAttribute(position, i).distanceToSquared(place);
      if (squared < least) [nearest, least] = [i, squared];
    }
    return at.fromBufferAttribute(normal, nearest);
  }

  /** Tool and arrow of a frame; the arrow is as long as the force is large, the peak a third of the body. It begins at the hand's
   * point; one that would go into the body, which would hide it, ends there. */
  placeTool(frame, isShown) {
    const force = new Vector3(...frame.force_N);
    const size = force.length();
    this.tool.visible = isShown && frame.has_tool;
    this.path.visible = isShown;
    this.arrow.visible = isShown && frame.has_tool && size > 1e-3 * this.peak;
    this.tool.position.set(...frame.tool_position_m);
    this.tool.quaternion.set(...frame.tool_orientation);
    if (!this.arrow.visible) return;
    const length = (PEAK_ARROW * this.extent.size * size) / this.peak;
    const way = force.normalize();
    this.arrow.position.copy(this.tool.position);
    if (way.dot(this.outwardNear(this.tool.position)) < 0) this.arrow.position.addScaledVector(way, -length);
    this.arrow.quaternion.copy(new Quaternion().setFromUnitVectors(UP, way));
    this.arrow.scale.setScalar(length);
  }

  draw() { this.renderer.render(this.scene, this.camera); }
}
