// The sheet in 3D, drawn by three.js.
import {
  AmbientLight, BackSide, BufferAttribute, BufferGeometry, DirectionalLight, FrontSide, Group, LineBasicMaterial, LineDashedMaterial,
  LineSegments, Mesh, MeshLambertMaterial, PerspectiveCamera, Scene, Vector3, WebGLRenderer, Color,
} from "three";
import {OrbitControls} from "three/addons/controls/OrbitControls.js";

const FRONT = {paper: new Color("#ffffff"), shape: new Color("#ffcf4d")};
const BACK = {paper: new Color("#b9cbe0"), shape: new Color("#e3a520")};
const INK = {M: new Color("#b3001b"), V: new Color("#0b4f9e"), B: new Color("#444444"), F: new Color("#999999")};
const NOW = new Color("#ff7a00");

/** Draws a `Folding` on a canvas. Throws where the browser has no WebGL. */
export class FoldScene {
  constructor(canvas, onTurned = () => {}) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({canvas, antialias: true, alpha: true});
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(28, 1, 0.05, 40);
    this.home();
    const sun = new DirectionalLight(0xffffff, 1.7);
    sun.position.set(0.6, 0.8, 1);
    this.camera.add(sun);
    this.scene.add(this.camera, new AmbientLight(0xffffff, 1.6));
    this.paper = new Group();
    this.scene.add(this.paper);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enablePan = false;
    this.controls.enableZoom = true;
    this.controls.minDistance = 1.2;
    this.controls.maxDistance = 8;
    this.controls.autoRotateSpeed = 1.6;
    this.controls.addEventListener("change", () => this.paint());
    this.controls.addEventListener("start", () => { this.turning = false; onTurned(); });
    this.turning = false;
    new ResizeObserver(() => this.paint()).observe(canvas);
  }

  home() { this.camera.position.set(0.85, -1.7, 2.2); this.camera.up.set(0, 1, 0); this.camera.lookAt(0, 0, 0); }
  look(x, y, z) { this.camera.position.set(x, y, z).setLength(2.9); this.controls.update(); this.paint(); }
  turn(dx, dy) {
    const at = this.camera.position.clone(), up = this.camera.up.clone();
    at.applyAxisAngle(up, -dx);
    at.applyAxisAngle(new Vector3().crossVectors(up, at).normalize(), -dy);
    this.camera.position.copy(at);
    this.controls.update();
    this.paint();
  }

  /** Take another pattern. */
  show(folding) {
    for (const one of [...this.paper.children]) { this.paper.remove(one); one.geometry.dispose(); one.material.dispose(); }
    this.folding = folding;
    const {parts, faces, edgeOf} = folding;
    let triangles = 0, sides = 0;
    for (const part of parts) { triangles += part.corners.length - 2; sides += part.corners.length; }
    this.at = new BufferAttribute(new Float32Array(9 * triangles), 3);
    this.ends = new BufferAttribute(new Float32Array(6 * sides), 3);
    this.inks = new BufferAttribute(new Float32Array(6 * sides), 3);
    this.places = parts.map((part) => new Float64Array(3 * part.corners.length));
    // a side of a part is on an edge, or on the cut
    this.sideEdge = parts.map(({f, corners: all}) => all.map(([a, b], k) => {
      const [c, d] = all[(k + 1) % all.length], ends = new Set([a, b, c, d]);
      const face = faces[f];
      for (let i = 0; i < face.length; i++) {
        const p = face[i], q = face[(i + 1) % face.length];
        if ([...ends].every((v) => v === p || v === q)) return edgeOf(p, q) ?? -1;
      }
      return -1;
    }));
    const mesh = (side, colours) => {
      const geometry = new BufferGeometry(), values = new Float32Array(9 * triangles);
      let k = 0;
      for (const part of parts) for (let n = 0; n < 3 * (part.corners.length - 2); n++) { colours[part.inside ? "shape" : "paper"].toArray(values, k); k += 3; }
      geometry.setAttribute("position", this.at);
      geometry.setAttribute("color", new BufferAttribute(values, 3));
      const material = new MeshLambertMaterial({vertexColors: true, flatShading: true, side, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1});
      const made = new Mesh(geometry, material);
      made.frustumCulled = false;
      this.paper.add(made);
    };
    mesh(FrontSide, FRONT);
    mesh(BackSide, BACK);
    const lines = new BufferGeometry();
    lines.setAttribute("position", this.ends);
    lines.setAttribute("color", this.inks);
    const drawn = new LineSegments(lines, new LineBasicMaterial({vertexColors: true}));
    drawn.frustumCulled = false;
    const knife = new BufferGeometry();
    this.knifeAt = new BufferAttribute(new Float32Array(6), 3);
    knife.setAttribute("position", this.knifeAt);
    this.knife = new LineSegments(knife, new LineDashedMaterial({color: 0xd00000, dashSize: 6, gapSize: 3}));
    this.knife.frustumCulled = false;
    this.paper.add(drawn, this.knife);
  }

  /** Draw the sheet after `s` steps. See `Viewer` for `look`: gap, layers, away, only. */
  draw(s, {gap, layers, away, only}) {
    const {folding} = this, told = folding.place(s, gap), {where, lift, parts, size, last} = folding;
    const {rank} = last, end = s >= folding.count;
    const {inside, ends} = folding.cut;
    const t = s / folding.count, now = new Set(told.t > 0 && told.t < 1 ? folding.steps[told.step].edges : []);
    const at = this.at.array, to = this.ends.array, inks = this.inks.array;
    let n = 0, m = 0, radius = 1e-9;
    const [cx, cy] = folding.centre;
    parts.forEach((part, p) => {
      const place = this.places[p], hidden = rank[part.f] >= layers || (only && !part.inside), l = lift[part.f];
      const move = part.inside && !only ? [inside[0] * away * t, inside[1] * away * t, away * (1 - t) * 1.5] : [0, 0, 0];
      part.corners.forEach(([a, b, w], k) => {
        for (let i = 0; i < 3; i++) {
          const p0 = where[3 * a + i], q0 = where[3 * b + i];
          place[3 * k + i] = p0 + (q0 - p0) * w + l[i] + move[i] - (i === 0 ? cx : i === 1 ? cy : 0);
        }
        if (!hidden) radius = Math.max(radius, Math.hypot(place[3 * k], place[3 * k + 1], place[3 * k + 2]));
      });
      const count = part.corners.length;
      for (let k = 1; k < count - 1; k++) for (const c of [0, k, k + 1]) for (let i = 0; i < 3; i++) at[n++] = hidden ? 0 : place[3 * c + i];
      for (let k = 0; k < count; k++) {
        const e = this.sideEdge[p][k], colour = e < 0 ? INK.B : now.has(e) ? NOW : INK[folding.data.letters[e]] || INK.F;
        for (const c of [k, (k + 1) % count]) for (let i = 0; i < 3; i++) { to[m] = hidden ? 0 : place[3 * c + i]; inks[m] = [colour.r, colour.g, colour.b][i]; m++; }
      }
    });
    this.knife.visible = end && !only;
    if (this.knife.visible) {
      const [[x, y], [u, v]] = ends, h = away / 2, z = folding.levels * gap;
      this.knifeAt.array.set([x + inside[0] * h - cx, y + inside[1] * h - cy, z, u + inside[0] * h - cx, v + inside[1] * h - cy, z]);
      this.knifeAt.needsUpdate = true;
      this.knife.computeLineDistances();
    }
    for (const one of [this.at, this.ends, this.inks]) one.needsUpdate = true;
    this.paper.scale.setScalar(0.62 / Math.max(radius, 0.12 * size));
    this.paint();
    return told;
  }

  /** Turn slowly until the hand takes over. */
  spin(on) { this.turning = on; this.paint(); }

  paint() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => { this.asked = false; this.paintNow(); });
  }

  paintNow() {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (!width || !height) return;
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    if (this.width !== width || this.height !== height || this.ratio !== ratio) {
      Object.assign(this, {width, height, ratio});
      this.renderer.setPixelRatio(ratio);
      this.renderer.setSize(width, height, false);
      this.camera.aspect = width / height;
      this.camera.zoom = Math.min(1, width / height);
      this.camera.updateProjectionMatrix();
    }
    this.controls.autoRotate = this.turning;
    if (this.turning) { this.controls.update(); }
    this.renderer.render(this.scene, this.camera);
  }

  /** A picture of what is shown, as a PNG blob. */
  picture() {
    this.paintNow();
    return new Promise((done) => this.canvas.toBlob(done, "image/png"));
  }
}
