// The page of foldcut serve: a drawing, its pattern and the folded sheet, all live.
import {Board} from "./board.js";
import {drawPattern} from "./pattern.js";
import {FOLDED_PANE, PATTERN_PANE, Viewer} from "./viewer.js";
import {$, make, number, put, pathOf} from "./words.js";

const OWN = {"X-Foldcut": "1"};
const LEVELS = [
  ["easy", "the fewest folds"], ["", "the most exact that two hands can fold"], ["normal", "at most 2 mm off on A4"],
  ["fine", "at most 0.5 mm off on A4"], ["exact", "exactly as drawn"],
];
const FIELDS = ["sheet", "margin", "profile", "material", "treatment", "tolerance", "folds", "open", "small-parts", "simplify", "min-crease", "symmetry", "ribbon"];
const CALM_MS = 300;
/** A change is folded when nothing else has changed for so long. */
const LOOK_MS = 120;
const LARGEST_LINK = 6000;
/** Letters of a drawing that goes into a link. */
const PICTURES = /^image\/(svg\+xml|png|jpeg|gif|webp|bmp)$/;

const LIVE = `<dl id="numbers"></dl><div id="remarks"></div><p id="wrong" role="alert" hidden></p>
<div id="busy" hidden><progress id="bar" max="1" aria-label="How far it is"></progress><span id="stage"></span> <button type="button" id="stop">Stop</button></div>`;

/** What is cut out: {kind: "file", file, ending, name} | {kind: "sample", name} | {kind: "text", text, font} | {kind: "corners", loops, name}. */
let source = null;
let viewer, board, choices = {machines: {}}, outlines = {}, job = null, turn = 0, calm = null, poll = null, last = null, kept = null;

export function startServe() {
  $("pattern-pane").innerHTML = LIVE + PATTERN_PANE;
  $("folded-pane").innerHTML = FOLDED_PANE;
  viewer = new Viewer();
  board = new Board((loops) => edited(loops));
  for (const id of FIELDS) $(id).addEventListener("change", changed);
  $("profile").addEventListener("change", machineChosen);
  $("level").oninput = () => { tellLevel(); changed(); };
  $("file").onchange = () => { if ($("file").files[0]) takeFile($("file").files[0]); };
  $("text").oninput = $("font").onchange = () => { if ($("text").value.trim()) takeText($("text").value.trim()); };
  $("new").onclick = () => { board.drawing = true; take({kind: "corners", loops: [], name: "drawing"}); say("Click on the board to set corners; drag them as you like."); };
  $("corners").onchange = () => edited(numbersToLoops($("corners").value), true);
  $("stop").onclick = async () => { turn += 1; await forget(); say("Stopped."); };
  $("longer").onclick = () => start(false);
  $("share").onclick = share;
  $("keep").onclick = keep;
  $("download").onclick = () => menu($("files").hidden);
  document.addEventListener("keydown", (event) => { if (event.key === "Escape" && !$("files").hidden) { menu(false); $("download").focus(); } });
  document.addEventListener("click", (event) => { if (!$("downloads").contains(event.target)) menu(false); });
  dropping();
  tellLevel();
  window.addEventListener("pagehide", () => { if (job) drop(job, {keepalive: true}); });
  Promise.all([fetch("choices"), fetch("samples")].map((one) => one.then((answer) => answer.json()))).then(([known, loops]) => {
    choices = known; outlines = loops;
    offerChoices();
    restore();
    document.body.dataset.ready = "yes";
  }).catch(() => wrong("The server does not answer; is foldcut serve still running?"));
}

const say = (text) => { $("said").textContent = text; };
const wrong = (text) => { $("wrong").textContent = text; $("wrong").hidden = !text; };
const menu = (open) => { $("files").hidden = !open; $("download").setAttribute("aria-expanded", String(open)); };
const options = (select, pairs) => select.append(...pairs.map(([text, value]) => new Option(text, value)));

/* ---- choices ---- */
function offerChoices() {
  for (const [name, loops] of Object.entries(outlines)) {
    const points = loops.flat(), xs = points.map((p) => p[0]), ys = points.map((p) => p[1]), x = Math.min(...xs), y = Math.min(...ys);
    const svg = put(null, "svg", {viewBox: `${x} 0 ${Math.max(...xs) - x} ${Math.max(...ys) - y}`, "aria-hidden": "true"});
    put(svg, "path", {d: pathOf(loops, Math.max(...ys)), "fill-rule": "evenodd", class: "thumb"});
    $("samples").append(make("button", {type: "button", "data-sample": name, title: name, "aria-label": `Sample: ${name}`, "aria-pressed": "false", onclick: () => take({kind: "sample", name})}, svg));
  }
  options($("font"), choices.fonts.map((name) => [name, name]));
  options($("profile"), Object.entries(choices.machines).map(([name, machine]) => [machine.title, name]));
  options($("treatment"), choices.treatments.map((name) => [name, name]));
  $("marks").append(...choices.marks.map((name) => make("label", {}, make("input", {type: "checkbox", value: name, onchange: changed}), ` ${name}`)));
  $("file").accept = choices.endings.join(",");
}

function machineChosen() {
  const machine = choices.machines[$("profile").value];
  $("material").replaceChildren(new Option("the machine's first", ""));
  options($("material"), machine ? machine.materials.map((name) => [name, name]) : []);
  for (const box of $("marks").querySelectorAll("input")) box.checked = !!machine && machine.marks.includes(box.value);
}

const tellLevel = () => { const words = LEVELS[$("level").value][1]; $("level-words").textContent = words; $("level").setAttribute("aria-valuetext", words); };

/* ---- what is cut out ---- */
function take(next) {
  source = next;
  if (next.kind !== "corners") board.drawing = false;
  const loops = next.kind === "corners" ? next.loops : next.kind === "sample" ? outlines[next.name] || [] : [];
  board.show(loops);
  $("corners").value = loopsToNumbers(board.loops);
  $("name").textContent = next.name || "";
  document.title = next.name ? `${next.name} – foldcut` : "foldcut";
  if (next.kind !== "text") $("text").value = "";
  if (next.kind !== "file") $("file").value = "";
  for (const button of $("samples").children) button.setAttribute("aria-pressed", String(next.kind === "sample" && button.dataset.sample === next.name));
  picture(next);
  hint();
  changed();
}

/** Until the server has read a file, show what the browser can of it. */
function picture(next) {
  if ($("photo").src) { URL.revokeObjectURL($("photo").src); $("photo").removeAttribute("src"); }
  const shown = next.kind === "file" && PICTURES.test(next.file.type);
  if (shown) $("photo").src = URL.createObjectURL(next.file);
  $("photo").hidden = !shown;
  $("word").hidden = next.kind !== "text";
  $("word").textContent = next.kind === "text" ? next.text : "";
}

function hint() {
  $("hint").textContent = !source ? "" : board.loops.length && board.handles ? "Drag corners; click on a side to add one; Delete takes the one with the focus away." : board.loops.length ? "It has too many corners to drag." : "";
}

function takeFile(file) {
  const dot = file.name.lastIndexOf(".");
  take({kind: "file", file, ending: file.name.slice(Math.max(dot, 0)).toLowerCase(), name: dot > 0 ? file.name.slice(0, dot) : file.name});
}

const takeText = (text) => take({kind: "text", text, font: $("font").value, name: text});

/** The drawing was changed by hand: from now on it is made of its corners, and keeps its name. */
function edited(loops, shown = false) {
  source = {kind: "corners", loops, name: source?.name || "drawing"};
  if (shown) board.show(loops);
  $("photo").hidden = $("word").hidden = true;
  $("corners").value = loopsToNumbers(board.loops);
  $("name").textContent = source.name;
  for (const button of $("samples").children) button.setAttribute("aria-pressed", "false");
  hint();
  changed();
}

const loopsToNumbers = (loops) => loops.map((loop) => loop.map((p) => p.map((v) => +v.toFixed(2)).join(",")).join(" ")).join("\n");
const numbersToLoops = (text) => text.split("\n").map((line) => line.trim().split(/\s+/).map((pair) => pair.split(",").map(Number)).filter((p) => p.length === 2 && p.every(Number.isFinite))).filter((loop) => loop.length);

function dropping() {
  const over = (on) => document.body.classList.toggle("dropping", on);
  document.addEventListener("dragover", (event) => { event.preventDefault(); over(true); });
  document.addEventListener("dragleave", () => over(false));
  document.addEventListener("drop", (event) => { event.preventDefault(); over(false); if (event.dataTransfer.files[0]) takeFile(event.dataTransfer.files[0]); });
}

/* ---- folding ---- */
function changed() {
  clearTimeout(calm);
  remember();
  const drawn = source && (source.kind !== "corners" || source.loops.some((loop) => loop.length > 2));
  if (drawn) calm = setTimeout(() => start(true), CALM_MS);
}

const drop = (token, more = {}) => fetch(`jobs/${token}`, {method: "DELETE", headers: OWN, ...more}).catch(() => {});

async function forget() {
  clearTimeout(poll);
  clearTimeout(calm);
  $("busy").hidden = true;
  menu(false);
  $("download").disabled = $("longer").disabled = true;
  if (job) { const token = job; job = null; await drop(token); }
}

function query(quick) {
  const asked = {effort: "normal"};
  for (const id of FIELDS) if ($(id).value) asked[id] = $(id).value;
  const level = LEVELS[$("level").value][0];
  if (level) asked.level = level;
  asked.marks = [...$("marks").querySelectorAll(":checked")].map((box) => box.value).join() || "none";
  asked.name = source.name;
  if (quick) asked.quick = "1";
  if (source.kind === "sample") asked.sample = source.name;
  if (source.kind === "text") Object.assign(asked, {text: source.text, font: source.font});
  if (source.kind === "file") asked.ending = source.ending;
  if (source.kind === "corners") asked.ending = ".json";
  return asked;
}

async function start(quick) {
  const mine = ++turn;
  await forget();
  if (mine !== turn || !source) return;
  const body = source.kind === "file" ? source.file : source.kind === "corners" ? JSON.stringify({loops: source.loops.filter((loop) => loop.length > 2), units: "mm"}) : null;
  wrong("");
  say(quick ? "Looking for a pattern …" : "Searching longer …");
  $("busy").hidden = false;
  $("bar").removeAttribute("value");
  $("stage").textContent = "starting";
  try {
    const answer = await fetch(`jobs?${new URLSearchParams(query(quick))}`, {method: "POST", headers: OWN, body}), got = await answer.json();
    if (mine !== turn) { if (got.job) drop(got.job); return; }
    if (!answer.ok) { fail(got.error); return; }
    job = got.job;
    await look(mine, quick, 0);
  } catch { if (mine === turn) fail("The server does not answer; is foldcut serve still running?"); }
}

/** No pattern beside an error: it would be another drawing's. After a quick look there may be one for who searches longer. */
function fail(text, quick = false) {
  $("busy").hidden = true;
  wrong(text);
  say("There is no pattern.");
  document.body.classList.add("stale");
  $("longer").disabled = !quick;
}

async function look(mine, quick, seen) {
  const token = job, answer = await fetch(`jobs/${token}`), got = await answer.json();
  if (mine !== turn || token !== job) return;
  const folding = got.state === "waiting" || got.state === "folding";
  if (!answer.ok || got.state === "failed") { fail(got.error, answer.ok && quick); return; }
  if (!folding || got.patterns.length > seen) {
    const data = await (await fetch(`jobs/${token}/shown`)).json();
    if (mine !== turn || token !== job) return;
    if (data.flat) {
      if (!performance.getEntriesByName("first").length) performance.mark("first");
      show(data);
      numbers(folding ? got.patterns.at(-1) : null, got.report);
    }
  }
  ladder(folding ? got.patterns : got.report.ladder?.levels || [], folding ? -1 : got.report.ladder?.taken);
  if (folding) {
    if (got.fraction) $("bar").value = got.fraction;
    $("stage").textContent = `${got.state === "waiting" ? "waiting for its turn" : got.stage || "starting"}, ${got.seconds.toFixed(0)} s`;
    poll = setTimeout(() => look(mine, quick, got.patterns.length).catch(() => fail("The server does not answer.")), LOOK_MS);
    return;
  }
  $("busy").hidden = true;
  say(`Verified: it folds flat, and one straight cut gives ${got.name}.`);
  last = {...last, report: got.report, name: got.name};
  $("longer").disabled = !quick;
  $("keep").disabled = false;
  offer(token, got);
}

function show(data) {
  document.body.classList.remove("stale");
  viewer.show(data, last && +$("fold").max ? +$("fold").value / +$("fold").max : 1);
  last = {data};
  // the board has closed outlines only
  if ((source.kind === "file" || source.kind === "text") && !$("open").value) {
    board.show(data.drawn || data.shape);
    $("photo").hidden = $("word").hidden = true;
    $("corners").value = loopsToNumbers(board.loops);
    hint();
  }
}

/* ---- what it costs ---- */
function numbers(level, report) {
  const rows = level
    ? [["folds", level.folds], ["layers at the cut", level.layers], ["shortest crease", mm(level.shortest_mm)], ["off the drawing", mm(level.off_by_mm)]]
    : [["folds", report.actions], ["layers at the cut", report.layers_at_cut], ["shortest crease", mm(report.shortest_crease_mm)], ["off the drawing", mm(report.moved_mm ?? 0)],
      ["thickest place", `${mm(report.thickness_mm)} of ${report.paper}`]];
  if (report?.difficulty) rows.unshift(["to fold", report.difficulty.text.split(" (")[0]]);
  $("numbers").replaceChildren(...rows.map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, String(value)))));
  const more = level ? [] : [report.difficulty?.text, ...(report.warnings || []), ...(report.notes || []), ...(report.next || [])].filter(Boolean);
  $("remarks").replaceChildren();
  if (more.length) $("remarks").append(make("details", {}, make("summary", {}, number(more.length, "remark")), make("ul", {}, ...more.map((text) => make("li", {}, text)))));
}

const mm = (value) => (value === null || value === undefined ? "none" : `${value >= 10 ? Math.round(value) : value >= 0.1 || value < 0.001 ? value.toFixed(1) : value.toPrecision(1)} mm`);

function ladder(levels, taken) {
  $("ladder").replaceChildren(...levels.map((level, k) => make("li", {"aria-current": k === taken ? "true" : null},
    make("span", {}, level.tolerance_mm ? `within ${+level.tolerance_mm.toPrecision(2)} mm` : "as drawn"),
    make("span", {}, level.folds === null ? "no pattern" : `${number(level.folds, "fold")}${level.for_hands ? "" : ", hard"}`))));
}

/* ---- files ---- */
const WORDS = {"pattern-kit.pdf": "Pattern, instructions and picture in one", "pattern.pdf": "The pattern to print", "job.pdf": "The pattern to print, for the machine", "guide.pdf": "How to fold it, step by step", "guide.html": "The same as a web page", "pattern.svg": "The pattern as a drawing", "pattern.png": "A picture of the pattern", "pattern.html": "This page of the pattern, to keep", "pattern.fold": "For origami programs", "pictures.png": "Pattern, folded sheet and cut in pictures", "pattern.zip": "All in one archive", "job.zip": "All for the machine", "pattern.cp": "For ORIPA and Crease Pattern Editor", "pattern.opx": "For ORIPA", "pattern.stl": "A scored sheet to print in 3D", "pattern.3mf": "The same in 3MF", "pattern.step": "A scored sheet for CAD", "pictures.svg": "The pictures as a drawing"};

function offer(token, got) {
  const made = new Set(got.files), all = [...new Set([...got.files, ...got.more])];
  const weight = (name) => (name.endsWith(".pdf") ? (name.startsWith("guide") ? 1 : 0) : name.startsWith("job") ? 2 : WORDS[name] ? 3 : 4);
  all.sort((p, q) => weight(p) - weight(q) || p.localeCompare(q));
  $("files").replaceChildren(...all.map((name) => {
    const link = make("a", {href: `jobs/${token}/${name}?download`, "data-file": name, onclick: (event) => { if (!made.has(name)) { event.preventDefault(); makeFile(token, name, link, made); } }},
      make("strong", {}, name.slice(name.indexOf(".") + 1).toUpperCase()), ` ${WORDS[name] || (name.startsWith("job.") ? "For the machine" : name)}`);
    return make("li", {}, link);
  }));
  $("download").disabled = false;
}

async function makeFile(token, name, link, made) {
  if (link.dataset.making) return;
  link.dataset.making = "yes";
  say(`Making ${name} …`);
  const answer = await fetch(`jobs/${token}/${name}`, {method: "POST", headers: OWN});
  delete link.dataset.making;
  if (token !== job) return;
  if (!answer.ok) { wrong((await answer.json()).error); say(`${name} was not made.`); return; }
  made.add(name);
  say(`${name} is made.`);
  link.click();
}

/* ---- two variants beside each other ---- */
function keep() {
  if (kept) { kept = null; $("kept")?.remove(); $("keep").textContent = "Keep to compare"; document.body.classList.remove("comparing"); return; }
  if (!last?.report) return;
  kept = last;
  const svg = put(null, "svg", {class: "picture", role: "img", "aria-label": "Crease pattern that was kept"});
  drawPattern(svg, kept.data);
  const table = $("numbers").cloneNode(true);
  table.removeAttribute("id");
  $("app").append(make("section", {class: "pane", id: "kept", "aria-label": "Kept to compare"}, make("h2", {}, `Kept: ${kept.name}, ${$("level-words").textContent}`), table, make("div", {class: "held"}, svg)));
  document.body.classList.add("comparing");
  $("keep").textContent = "Stop comparing";
}

/* ---- the state in the address ---- */
function stateNow() {
  const fields = {};
  for (const id of FIELDS) if ($(id).value && $(id).value !== $(id).defaultValue && $(id).value !== ($(id).options?.[0]?.value ?? "")) fields[id] = $(id).value;
  const drawing = !source || source.kind === "file" ? null : source;
  return {level: +$("level").value, fields, drawing};
}

function remember() {
  const text = JSON.stringify(stateNow());
  const drawing = text.length <= LARGEST_LINK;
  history.replaceState(null, "", `#${encodeURIComponent(drawing ? text : JSON.stringify({...stateNow(), drawing: null}))}`);
  return drawing && source?.kind !== "file";
}

async function share() {
  // what a file became is small enough for a link more often than the file
  if (source?.kind === "file" && last) {
    const loops = board.loops.map((loop) => loop.map((p) => p.map((v) => +v.toFixed(2))));
    const text = JSON.stringify({...stateNow(), drawing: {kind: "corners", loops, name: source.name}});
    if (text.length <= LARGEST_LINK) { history.replaceState(null, "", `#${encodeURIComponent(text)}`); await copy(true); return; }
  }
  await copy(remember());
}

async function copy(whole) {
  try {
    await navigator.clipboard.writeText(location.href);
    say(whole ? "The link is copied; the drawing is in it." : "The link is copied. The drawing is too large to be in it: send the file as well.");
  } catch { say("The link is in the address line of the browser; copy it there."); }
}

/** Take the state in the address, if there is one; whatever in it is not understood is left out. */
function restore() {
  let state = null;
  try { state = JSON.parse(decodeURIComponent(location.hash.slice(1))); } catch { /* no state */ }
  if (state && typeof state === "object") {
    if (LEVELS[state.level]) $("level").value = state.level;
    for (const id of FIELDS) if (typeof state.fields?.[id] === "string") { $(id).value = state.fields[id]; if (id === "profile") machineChosen(); }
    tellLevel();
  }
  const drawing = state?.drawing;
  const isLoops = (loops) => Array.isArray(loops) && loops.every((loop) => Array.isArray(loop) && loop.every((p) => Array.isArray(p) && p.length === 2 && p.every(Number.isFinite)));
  if (drawing?.kind === "sample" && outlines[drawing.name]) take({kind: "sample", name: drawing.name});
  else if (drawing?.kind === "text" && typeof drawing.text === "string" && drawing.text.trim()) { $("text").value = drawing.text; if (choices.fonts.includes(drawing.font)) $("font").value = drawing.font; takeText(drawing.text.trim()); }
  else if (drawing?.kind === "corners" && isLoops(drawing.loops)) take({kind: "corners", loops: drawing.loops, name: String(drawing.name || "drawing")});
  else take({kind: "sample", name: outlines.star ? "star" : Object.keys(outlines)[0]});
}
