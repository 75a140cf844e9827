// The drawing: loops of corners in mm, y up. Corners are dragged, added on a side, and taken away.
import {$, pathOf, put} from "./words.js";

const MOST_HANDLES = 150;
/** A drawing with more corners than this is shown without handles. */
const UNDOS = 100;

export class Board {
  /** `changed(loops)` is called after each change by hand. */
  constructor(changed) {
    this.svg = $("board");
    this.changed = changed;
    this.loops = [];
    this.past = [];
    this.svg.addEventListener("pointerdown", (event) => this.down(event));
    this.svg.addEventListener("pointermove", (event) => { if (this.held) this.drag(this.at(event)); });
    for (const ended of ["pointerup", "pointercancel"]) this.svg.addEventListener(ended, () => { if (this.held) { this.held = null; this.fit(); this.changed(this.loops); } });
    this.svg.addEventListener("keydown", (event) => this.key(event));
    $("undo").onclick = () => this.undo();
    this.fit();
  }

  /** Show loops that come from elsewhere. */
  show(loops) {
    this.loops = loops.map((loop) => loop.map((p) => [...p]));
    this.past = [];
    this.fit();
  }

  remember() {
    this.past.push(this.loops.map((loop) => loop.map((p) => [...p])));
    if (this.past.length > UNDOS) this.past.shift();
  }

  undo() {
    if (!this.past.length) return;
    this.loops = this.past.pop();
    this.fit();
    this.changed(this.loops);
  }

  /** See the whole drawing; an empty board is 100 by 100 mm. */
  fit() {
    const points = this.loops.flat(), xs = points.map((p) => p[0]), ys = points.map((p) => p[1]);
    let [x, y, w, h] = [0, 0, 100, 100];
    if (points.length > 2) { x = Math.min(...xs); y = Math.min(...ys); w = Math.max(...xs) - x; h = Math.max(...ys) - y; }
    const margin = 0.08 * Math.max(w, h, 1e-6);
    Object.assign(this, {size: Math.max(w, h, 1e-6), top: y + h});
    this.svg.setAttribute("viewBox", `${x - margin} ${-margin} ${w + 2 * margin} ${h + 2 * margin}`);
    this.draw();
  }

  draw() {
    const {svg, loops, size} = this, focused = document.activeElement?.dataset?.corner;
    svg.replaceChildren();
    if (loops.length) put(svg, "path", {class: "shape", "fill-rule": "evenodd", "stroke-width": size / 250, d: pathOf(loops.filter((loop) => loop.length), this.top)});
    $("undo").disabled = !this.past.length;
    this.handles = loops.flat().length <= MOST_HANDLES;
    if (!this.handles) return;
    loops.forEach((loop, l) => loop.forEach(([x, y], k) => {
      put(svg, "circle", {cx: x, cy: this.top - y, r: size / 70, class: "handle", tabindex: 0, role: "button", "data-corner": `${l},${k}`, "aria-label": `Corner ${k + 1}${l ? ` of loop ${l + 1}` : ""}: ${x.toFixed(1)}, ${y.toFixed(1)}`});
    }));
    if (focused) svg.querySelector(`[data-corner="${focused}"]`)?.focus();
  }

  at(event) {
    const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
    return [p.x, this.top - p.y].map((v) => +v.toFixed(2));
  }

  down(event) {
    if (!this.handles) return;
    const at = this.at(event), near = 0.05 * this.size;
    let best = near, found = null;
    this.loops.forEach((loop, l) => loop.forEach((p, k) => { const d = Math.hypot(p[0] - at[0], p[1] - at[1]); if (d < best) { best = d; found = [l, k]; } }));
    this.remember();
    if (!found) found = this.add(at, near);
    if (!found) { this.past.pop(); return; }
    this.held = found;
    this.svg.setPointerCapture(event.pointerId);
    this.drag(at);
  }

  /** Add a corner: on the side that was hit, or at the end of a loop that is being drawn. */
  add(at, near) {
    let best = near, found = null;
    this.loops.forEach((loop, l) => loop.length > 2 && loop.forEach((p, k) => {
      const q = loop[(k + 1) % loop.length], d = [q[0] - p[0], q[1] - p[1]];
      const t = Math.max(0, Math.min(1, ((at[0] - p[0]) * d[0] + (at[1] - p[1]) * d[1]) / (d[0] ** 2 + d[1] ** 2 || 1)));
      const away = Math.hypot(at[0] - p[0] - t * d[0], at[1] - p[1] - t * d[1]);
      if (away < best) { best = away; found = [l, k + 1]; }
    }));
    if (!found && this.drawing) { if (!this.loops.length) this.loops.push([]); found = [0, this.loops[0].length]; }
    if (found) this.loops[found[0]].splice(found[1], 0, at);
    return found;
  }

  drag(at) {
    const [l, k] = this.held;
    this.loops[l][k] = at;
    this.draw();
  }

  key(event) {
    const held = event.target.dataset?.corner?.split(",").map(Number), move = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]}[event.key];
    if (!held || !(move || event.key === "Delete" || event.key === "Backspace")) return;
    event.preventDefault();
    this.remember();
    const [l, k] = held, loop = this.loops[l];
    if (move) loop[k] = loop[k].map((v, i) => +(v + move[i] * this.size / 100).toFixed(2));
    else if (loop.length > 3) loop.splice(k, 1);
    this.draw();
    this.changed(this.loops);
  }
}
