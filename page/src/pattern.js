// The crease pattern as SVG: kinds of lines that can be left out, zoom, and what a crease is.
import {besides} from "./folding.js";
import {$, number, pathOf, put} from "./words.js";

const NAMES = {M: "mountain", V: "valley", F: "flat"};
const ARROWS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};

/** Draw a pattern into an <svg>; returns its groups by name and the line of each crease. */
export function drawPattern(svg, data) {
  const {flat, edges, letters, sheet} = data, unit = Math.max(...sheet) / 300, y = (value) => sheet[1] - value;
  svg.replaceChildren();
  const group = (name) => put(svg, "g", {"data-name": name});
  put(svg, "rect", {width: sheet[0], height: sheet[1], class: "paper"});
  const groups = {shape: group("shape"), drawn: group("drawn"), first: group("first")};
  put(groups.shape, "path", {class: "shape", "fill-rule": "evenodd", "stroke-width": unit / 2, d: pathOf(data.shape, sheet[1])});
  if (data.drawn) put(groups.drawn, "path", {class: "drawn", "stroke-width": unit, d: pathOf(data.drawn, sheet[1])});
  for (const [[a, b], [c, d]] of data.first) put(groups.first, "line", {class: "first", x1: a, y1: y(b), x2: c, y2: y(d), "stroke-width": 4 * unit});
  for (const name of "MVB") groups[name] = group(name);
  const dashes = {M: `${6 * unit} ${1.5 * unit} ${unit} ${1.5 * unit}`, V: `${3.5 * unit} ${2 * unit}`};
  const lines = edges.map(([a, b], e) => put(groups[letters[e]] || groups.B, "line", {
    x1: flat[a][0], y1: y(flat[a][1]), x2: flat[b][0], y2: y(flat[b][1]),
    class: letters[e], "stroke-width": unit, "stroke-dasharray": dashes[letters[e]] || "none",
  }));
  svg.setAttribute("viewBox", [-6 * unit, -6 * unit, sheet[0] + 12 * unit, sheet[1] + 12 * unit].join(" "));
  return {groups, lines, unit};
}

export class PatternView {
  /** Works the elements of `viewer.js`; `onChoose` is called with the crease that is chosen. */
  constructor() {
    this.svg = $("pattern");
    this.data = null;
    this.svg.addEventListener("wheel", (event) => { event.preventDefault(); this.zoom(event.deltaY > 0 ? 1.2 : 1 / 1.2, ...this.inSheet(event)); }, {passive: false});
    this.svg.addEventListener("pointerdown", (event) => { if (this.data) { this.grip = this.inSheet(event); this.svg.setPointerCapture(event.pointerId); } });
    for (const ended of ["pointerup", "pointercancel"]) this.svg.addEventListener(ended, () => { this.grip = null; });
    this.svg.addEventListener("pointermove", (event) => this.pointed(event));
    $("larger").onclick = () => this.zoom(1 / 1.4);
    $("smaller").onclick = () => this.zoom(1.4);
    $("whole").onclick = () => this.whole();
    $("before").onclick = () => this.step(-1);
    $("after").onclick = () => this.step(1);
    $("pattern-held").onkeydown = (event) => {
      const [dx, dy] = ARROWS[event.key] || [0, 0];
      if (!this.data) return;
      if ("+=-".includes(event.key)) this.zoom(event.key === "-" ? 1.4 : 1 / 1.4);
      else if (dx || dy) { this.view[0] += dx * this.view[2] / 10; this.view[1] += dy * this.view[3] / 10; this.move(); }
      else return;
      event.preventDefault();
    };
    for (const box of document.querySelectorAll("[data-layer]")) box.onchange = () => this.filter();
  }

  show(data) {
    const same = this.data && String(this.data.sheet) === String(data.sheet);
    this.data = data;
    Object.assign(this, drawPattern(this.svg, data));
    this.creases = data.edges.map((_, e) => e).filter((e) => data.letters[e] !== "B");
    this.chosen = put(this.svg, "line", {class: "chosen hidden", "stroke-width": 4 * this.unit});
    this.current = -1;
    const layer = new Array(data.faces.length);
    data.layers.forEach((face, at) => { layer[face] = at + 1; });
    this.joined = besides(data).map((faces) => faces.map((f) => layer[f]).sort((p, q) => p - q));
    $("has-drawn").classList.toggle("hidden", !data.drawn);
    $("has-first").classList.toggle("hidden", !data.first.length);
    $("tip").textContent = "Point at a crease, or go through them with the buttons.";
    this.filter();
    if (!same || !this.view) this.whole(); else this.move();
  }

  filter() {
    for (const box of document.querySelectorAll("[data-layer]"))
      this.svg.querySelector(`[data-name=${box.dataset.layer}]`)?.classList.toggle("hidden", !box.checked);
  }

  /** Show which creases move now. */
  mark(edges) {
    const now = new Set(edges);
    this.lines?.forEach((line, e) => line.classList.toggle("now", now.has(e)));
  }

  whole() {
    if (!this.data) return;
    const margin = 6 * this.unit, [width, height] = this.data.sheet;
    this.view = [-margin, -margin, width + 2 * margin, height + 2 * margin];
    this.move();
  }

  move() { this.svg.setAttribute("viewBox", this.view.join(" ")); }

  zoom(factor, x = this.view[0] + this.view[2] / 2, at = this.view[1] + this.view[3] / 2) {
    const wide = this.data.sheet[0], width = Math.min(Math.max(this.view[2] * factor, wide / 200), wide * 4), f = width / this.view[2];
    this.view = [x - (x - this.view[0]) * f, at - (at - this.view[1]) * f, width, this.view[3] * f];
    this.move();
  }

  inSheet(event) {
    const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(this.svg.getScreenCTM().inverse());
    return [p.x, p.y];
  }

  line(e) {
    const {flat, edges, sheet} = this.data, [a, b] = edges[e];
    return [flat[a][0], sheet[1] - flat[a][1], flat[b][0], sheet[1] - flat[b][1]];
  }

  pointed(event) {
    if (!this.data) return;
    const [px, py] = this.inSheet(event);
    if (this.grip) { this.view[0] += this.grip[0] - px; this.view[1] += this.grip[1] - py; this.move(); return; }
    let best = 4 * this.unit * this.view[2] / this.data.sheet[0], found = -1;
    this.creases.forEach((e, at) => {
      const [ax, ay, bx, by] = this.line(e), dx = bx - ax, dy = by - ay;
      const t = Math.max(0, Math.min(1, ((px - ax) * dx + (py - ay) * dy) / (dx * dx + dy * dy)));
      const away = Math.hypot(px - ax - t * dx, py - ay - t * dy);
      if (away < best && !this.groups[this.data.letters[e]]?.classList.contains("hidden")) { best = away; found = at; }
    });
    if (found >= 0 && found !== this.current) this.choose(found);
  }

  choose(at) {
    this.current = at;
    const {data} = this, e = this.creases[at], [a, b] = data.edges[e], [x1, y1, x2, y2] = this.line(e);
    for (const [key, value] of Object.entries({x1, y1, x2, y2})) this.chosen.setAttribute(key, value);
    this.chosen.classList.remove("hidden");
    const point = (v) => data.flat[v].map((c) => c.toFixed(1)).join(", ");
    $("tip").textContent = `Crease ${at + 1} of ${this.creases.length}: ${NAMES[data.letters[e]]}, ${Math.hypot(x2 - x1, y2 - y1).toFixed(1)} mm, ` +
      `from (${point(a)}) to (${point(b)}), joins layers ${this.joined[e].join(" and ")} of ${data.faces.length}.`;
  }

  /** Choose the next crease, and bring it into view for those who go through them without a pointer. */
  step(by) {
    if (!this.creases?.length) return;
    this.choose((Math.max(this.current, by > 0 ? -1 : 0) + by + this.creases.length) % this.creases.length);
    const [x1, y1, x2, y2] = this.line(this.creases[this.current]), x = (x1 + x2) / 2, at = (y1 + y2) / 2, {view} = this;
    if (x < view[0] || x > view[0] + view[2] || at < view[1] || at > view[1] + view[3]) { view[0] = x - view[2] / 2; view[1] = at - view[3] / 2; this.move(); }
  }
}

const PAINT = {
  paper: {fill: "#fff"}, shape: {fill: "none", stroke: "#888"}, drawn: {fill: "none", stroke: "#bbb"}, first: {stroke: "#e58a00", opacity: 0.5},
  M: {stroke: "#b3001b"}, V: {stroke: "#0b4f9e"}, B: {stroke: "#111"},
};
/** What the page's style sheet says, for a file without one. */

/** The pattern as an SVG file at its true size. */
export function patternFile(data) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  drawPattern(svg, data);
  const [width, height] = data.sheet;
  for (const one of svg.querySelectorAll("[class]")) for (const [key, value] of Object.entries(PAINT[one.getAttribute("class")] || {})) one.setAttribute(key, value);
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.setAttribute("width", `${width}mm`);
  svg.setAttribute("height", `${height}mm`);
  return new XMLSerializer().serializeToString(svg);
}

export const facts = (data) => {
  const count = (letter) => data.letters.filter((l) => l === letter).length;
  return `${number(count("M"), "mountain")} and ${number(count("V"), "valley")} on ${data.sheet[0]} × ${data.sheet[1]} mm, ` +
    `${number(data.faces.length, "face")}. Verified: it folds flat, and one straight cut gives the shape.`;
};
