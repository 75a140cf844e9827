// Pattern and folded sheet beside each other, with the player: the part that foldcut view and foldcut serve share.
import {Folding} from "./folding.js";
import {PatternView, patternFile} from "./pattern.js";
import {FoldScene} from "./scene.js";
import {$, fileStem, number, save} from "./words.js";

const KEY = (name, dash) => `<svg class="key" viewBox="0 0 26 6" aria-hidden="true"><line class="${name}" x1="0" x2="26" y1="3" y2="3" stroke-width="2" stroke-dasharray="${dash}"/></svg>`;

export const PATTERN_PANE = `
<h2 id="h-pattern">Crease pattern</h2>
<div class="held" id="pattern-held" tabindex="0" role="group" aria-label="Crease pattern; arrow keys move it, + and - zoom; the line below tells of the chosen crease">
<svg id="pattern" class="picture" role="img" aria-label="Crease pattern"></svg>
</div>
<div class="row" role="group" aria-label="Lines shown">
<label><input type="checkbox" data-layer="M" checked>${KEY("M", "8 2 2 2")}mountains</label>
<label><input type="checkbox" data-layer="V" checked>${KEY("V", "5 3")}valleys</label>
<label><input type="checkbox" data-layer="shape" checked>shape</label>
<label id="has-drawn"><input type="checkbox" data-layer="drawn" checked>${KEY("drawn", "none")}drawing</label>
<label id="has-first"><input type="checkbox" data-layer="first" checked>first folds</label>
</div>
<div class="row">
<button type="button" id="before" aria-label="Previous crease">‹ crease</button>
<button type="button" id="after" aria-label="Next crease">crease ›</button>
<button type="button" id="larger" aria-label="Zoom in">+</button>
<button type="button" id="smaller" aria-label="Zoom out">−</button>
<button type="button" id="whole">Whole sheet</button>
</div>
<p id="tip" aria-live="polite"></p>`;

export const FOLDED_PANE = `
<h2 id="h-folded">Fold and cut</h2>
<div class="held" id="folded-held" tabindex="0" role="group" aria-label="The sheet in 3D; arrow keys turn it, the slider below folds it">
<canvas id="folded" class="picture" role="img" aria-label="The sheet in 3D"></canvas>
<p id="no-3d" class="over hidden"></p>
</div>
<p id="step" aria-live="polite"></p>
<div class="row player">
<button type="button" id="back" aria-label="One step back">◂ step</button>
<button type="button" id="play">Play</button>
<button type="button" id="on" aria-label="One step on">step ▸</button>
<label class="wide"><span class="unseen">How far it is folded</span><input type="range" id="fold" min="0" value="0" step="1"></label>
</div>
<div class="row">
<label><input type="checkbox" id="cut">cut</label>
<label><input type="checkbox" id="only">only the shape</label>
<label><input type="checkbox" id="spin">turn</label>
<button type="button" id="front">From above</button>
<button type="button" id="side">From the side</button>
</div>
<div class="row">
<label class="wide">layers <input type="range" id="layers" min="1" step="1" aria-label="How many layers are shown, from the bottom"> <output id="layer-count"></output></label>
<label class="wide">apart <input type="range" id="apart" min="0" max="100" value="12" step="1" aria-label="How far apart the layers are drawn"></label>
</div>
<p id="stretch" aria-live="off"></p>`;

const TICKS = 100;
/** Positions of the slider in each step. */
const STEP_MS = 1100;

export class Viewer {
  constructor() {
    this.pattern = new PatternView();
    try {
      this.scene = new FoldScene($("folded"), () => { $("spin").checked = false; });
    } catch {
      $("no-3d").textContent = "This browser draws nothing in 3D (WebGL is off). The pattern is complete without it.";
      $("no-3d").classList.remove("hidden");
    }
    $("fold").oninput = () => { this.stop(); this.draw(); };
    $("apart").oninput = () => this.draw();
    $("layers").oninput = () => this.tellLayers();
    $("cut").onchange = () => { if (!$("cut").checked) $("only").checked = false; this.draw(); };
    $("only").onchange = () => { if ($("only").checked) $("cut").checked = true; this.draw(); };
    $("front").onclick = () => this.scene?.look(0, 0.001, 1);
    $("side").onclick = () => this.scene?.look(1, 0.12, 0.22);
    $("spin").onchange = () => this.scene?.spin($("spin").checked);
    $("play").onclick = () => (this.playing ? this.stop() : this.play());
    $("back").onclick = () => this.go(Math.ceil(+$("fold").value / TICKS) - 1);
    $("on").onclick = () => this.go(Math.floor(+$("fold").value / TICKS) + 1);
    window.addEventListener("beforeprint", () => this.printed(true));
    window.addEventListener("afterprint", () => this.printed(false));
    $("folded-held").onkeydown = (event) => {
      const [dx, dy] = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key] || [0, 0];
      if (!dx && !dy) return;
      this.scene?.turn(dx / 10, dy / 10);
      event.preventDefault();
    };
  }

  /** Show a pattern; `at`: where to begin, from 0, flat, to 1, folded. */
  show(data, at = 1) {
    this.stop();
    this.data = data;
    this.folding = new Folding(data);
    this.pattern.show(data);
    this.scene?.show(this.folding);
    // open lines may have all paper on one side of the cut: there is no shape to be shown alone
    $("only").disabled = !this.folding.parts.some((part) => part.inside);
    if ($("only").disabled) $("only").checked = false;
    $("fold").max = TICKS * this.folding.count;
    $("fold").value = at * TICKS * this.folding.count;
    $("layers").max = $("layers").value = data.faces.length;
    this.tellLayers();
  }

  tellLayers() {
    if (!this.data) return;
    $("layer-count").textContent = `${$("layers").value} of ${this.data.faces.length}`;
    this.draw();
  }

  draw() {
    if (!this.data) return;
    const {folding} = this, s = +$("fold").value / TICKS;
    const gap = $("apart").value / 100 * folding.size * 0.6 / Math.max(folding.levels, 6);
    const look = {gap: gap + 1e-4 * folding.size, layers: +$("layers").value, away: $("cut").checked ? folding.size * 0.1 : 0, only: $("only").checked};
    const told = this.scene ? this.scene.draw(s, look) : folding.place(s, look.gap);
    this.tell(s, told);
  }

  tell(s, told) {
    const {folding} = this, between = told.t > 0 && told.t < 1, k = Math.ceil(s) - 1, step = folding.steps[Math.max(k, 0)];
    this.pattern.mark(between ? step.edges : []);
    $("step").textContent = s === 0 ? `The flat sheet. ${number(folding.count, "step")} to fold it.` : `Step ${k + 1} of ${folding.count}: ${this.words(step)}.`;
    $("fold").setAttribute("aria-valuetext", $("step").textContent);
    $("stretch").textContent = s === 0 ? "Flat, as printed."
      : s === folding.count ? "Folded flat, exactly as verified, its layers drawn apart; the red line is the cut."
      : !between ? "Flat between two steps, exactly as verified; its layers are drawn apart."
      : told.exact ? "Exact: what moves turns about the line as one stiff piece, and nothing passes through anything."
      : `This movement is a picture and not computed: corners go the straight way, pulled until lengths nearly fit; they are off by ${(100 * told.off).toFixed(1)} % on average, and layers may pass through each other. Both ends are exact.`;
  }

  words(step) {
    const kinds = new Set(step.edges.map((e) => this.data.letters[e]));
    if (!step.line) return `${number(step.edges.length, "crease")} close${step.edges.length === 1 ? "s" : ""} together`;
    return `one straight fold, ${step.over ? "over (valley)" : "behind (mountain)"}${kinds.size > 1 ? ", through several layers" : ""}`;
  }

  go(step) {
    this.stop();
    const to = Math.min(Math.max(step, 0), this.folding?.count || 0) * TICKS;
    this.run(+$("fold").value, to, () => this.stop());
  }

  /** Fold it, cut it, and open the shape. */
  play() {
    if (!this.data) return;
    const end = +$("fold").max, cutting = $("cut").checked && +$("fold").value > 0;
    const wait = (then) => { this.later = setTimeout(then, 700); };
    const unfold = (from) => this.run(from, 0, () => this.stop());
    const open = () => { $("only").checked = !$("only").disabled; unfold(end); };
    if ($("only").checked && +$("fold").value > 0) { unfold(+$("fold").value); return; }
    if (!cutting) { $("cut").checked = $("only").checked = false; }
    const from = +$("fold").value >= end && !cutting ? 0 : +$("fold").value;
    const cut = () => { $("cut").checked = true; this.draw(); wait(open); };
    this.run(from, end, () => wait(cut));
  }

  run(from, to, done) {
    const started = performance.now(), long = Math.abs(to - from) / TICKS * STEP_MS;
    this.playing = true;
    $("play").textContent = "Pause";
    const frame = (now) => {
      const part = long ? Math.min((now - started) / long, 1) : 1;
      $("fold").value = from + (to - from) * part;
      this.draw();
      if (part < 1) this.frame = requestAnimationFrame(frame); else done();
    };
    this.frame = requestAnimationFrame(frame);
  }

  stop() {
    cancelAnimationFrame(this.frame);
    clearTimeout(this.later);
    this.playing = false;
    $("play").textContent = "Play";
  }

  /** Paper gets the whole sheet at its true size. */
  printed(now) {
    const {svg} = this.pattern, [width, height] = this.data?.sheet || [0, 0];
    if (now) svg.setAttribute("viewBox", `0 0 ${width} ${height}`); else if (this.data) this.pattern.move();
    svg.style.width = now ? `${width}mm` : "";
    svg.style.height = now ? `${height}mm` : "";
  }

  saveSvg() { save(`${fileStem(this.data.title)}.svg`, patternFile(this.data), "image/svg+xml"); }

  async savePicture() { if (this.scene) save(`${fileStem(this.data.title)}.png`, await this.scene.picture()); }
}
