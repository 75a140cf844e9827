// How the sheet moves: the states between the steps, and every place in between. Nothing here draws.
//
// A straight fold is exact: its faces turn about the line as one rigid piece. What closes together is a picture: corners
// go the straight way and are then pulled until lengths nearly fit; `off` says how far lengths are off.

const ROUNDS = 60;
/** Lengths are pulled so often at most; large patterns less often, so that a picture takes a few milliseconds. */

export class Folding {
  /** `data`: what foldcut wrote: flat, folded, edges, letters, faces, steps, and `layers` of the folded state. */
  constructor(data) {
    Object.assign(this, {data, faces: data.faces, size: Math.max(...data.sheet)});
    this.edgeOf = finder(data);
    this.beside = besides(data);
    const steps = data.steps.length ? data.steps : [{edges: data.edges.map((_, e) => e), at: data.folded, layers: data.layers}];
    this.steps = steps;
    const folded = new Set();
    const identity = data.faces.map((_, f) => f);
    this.states = [this.state(data.flat, identity, folded)];
    for (const step of steps) {
      for (const e of step.edges) folded.add(e);
      this.states.push(this.state(step.at, step.layers, folded));
    }
    this.last = this.states.at(-1);
    this.parts = partsOf(data);
    this.bars = barsOf(data);
    this.cut = this.cutLine();
    this.where = new Float64Array(3 * data.flat.length);
    this.lift = data.faces.map(() => [0, 0, 0]);
    this.levels = Math.max(...this.last.level) + 1;
  }

  get count() { return this.steps.length; }

  /** A state: places, which faces show their front, and the level of each face: how many layers lie under it. */
  state(at, layers, folded) {
    const rank = new Array(this.faces.length);
    layers.forEach((face, r) => { rank[face] = r; });
    const up = this.faces.map((face) => area(face, at) > 0);
    const centre = middle(at);
    return {at, rank, up, centre, level: levelsOf(this.faces, at, rank, this.beside, folded, this.size)};
  }

  /** The line of the cut in the last state: a point, its direction, and the direction to the inside of the shape. */
  cutLine() {
    const from = this.data.folded, to = this.last.at;
    const a = 0;
    let b = 1, c = 0, far = -1;
    from.forEach((p, v) => { const d = dist(p, from[0]); if (d > far) { far = d; b = v; } });
    const u = unit(from[a], from[b]), U = unit(to[a], to[b]);
    far = -1;
    const away = (p, o, w) => (p[0] - o[0]) * -w[1] + (p[1] - o[1]) * w[0];
    from.forEach((p, v) => { const d = Math.abs(away(p, from[a], u)); if (d > far) { far = d; c = v; } });
    const sign = Math.sign(away(from[c], from[a], u) * away(to[c], to[a], U)) || 1;
    const turn = (d) => {
      const along = d[0] * u[0] + d[1] * u[1], across = sign * (d[0] * -u[1] + d[1] * u[0]);
      return [along * U[0] - across * U[1], along * U[1] + across * U[0]];
    };
    const shift = turn([-from[a][0], -from[a][1]]);
    const xs = from.map((p) => p[0]);
    const ends = [Math.min(...xs), Math.max(...xs)].map((x) => { const p = turn([x, 0]); return [p[0] + shift[0] + to[a][0], p[1] + shift[1] + to[a][1]]; });
    return {ends, inside: turn([0, 1])};
  }

  /** Put everything where it is at `s`: 0 = flat, k = after k steps. `gap`: mm between layers. Returns {exact, off}. */
  place(s, gap) {
    const k = Math.min(Math.floor(s), this.count - 1), t = s - k;
    const before = this.states[k], after = this.states[k + 1], step = this.steps[k];
    const {where, lift} = this, still = t === 0 || t === 1;
    const heights = (state) => { const most = Math.max(...state.level); return state.level.map((l) => (l - most / 2) * gap); };
    const low = heights(before), high = heights(after);
    this.centre = [0, 1].map((i) => before.centre[i] * (1 - t) + after.centre[i] * t);
    lift.forEach((l, f) => { l[0] = 0; l[1] = 0; l[2] = low[f] * (1 - t) + high[f] * t; });
    let off = 0;
    if (still) (t ? after : before).at.forEach((p, v) => { where[3 * v] = p[0]; where[3 * v + 1] = p[1]; where[3 * v + 2] = 0; });
    else if (step.line) this.turn(before, step, t, low, high);
    else off = this.collapse(before, after, step, t, gap);
    return {exact: still || !!step.line, off, step: k, t};
  }

  /** Turn what a straight fold moves about its line, and its layers from their heights before, `low`, to those after. */
  turn(before, step, t, low, high) {
    const {where, lift} = this, [p, q] = step.line, along = unit(p, q), across = [-along[1], along[0]];
    const off = (point) => (point[0] - p[0]) * across[0] + (point[1] - p[1]) * across[1];
    const turns = new Uint8Array(before.at.length);
    let side = 0;
    for (const f of step.moved) for (const v of this.faces[f]) { turns[v] = 1; side += off(before.at[v]); }
    side = Math.sign(side);
    const angle = Math.PI * t * (step.over ? 1 : -1), c = Math.cos(angle), sn = Math.sin(angle);
    before.at.forEach((point, v) => {
      const d = off(point), shift = turns[v] ? d * (c - 1) : 0;
      where[3 * v] = point[0] + across[0] * shift;
      where[3 * v + 1] = point[1] + across[1] * shift;
      where[3 * v + 2] = turns[v] ? d * side * sn : 0;
    });
    for (const f of step.moved) {
      const h = low[f] * (1 - t) - high[f] * t; // along the normal, which turns over with the faces
      lift[f][0] = -across[0] * side * sn * h; lift[f][1] = -across[1] * side * sn * h; lift[f][2] = c * h;
    }
  }

  /** Where vertices are while creases close together; returns how far lengths are off on average, 0.01 = 1 %. */
  collapse(before, after, step, t, gap) {
    const {where, bars, data} = this;
    const lean = new Float64Array(where.length / 3);
    for (const e of step.edges) {
      const s = {M: 1, V: -1}[data.letters[e]] || 0, [a, b] = data.edges[e], f = this.beside[e][0];
      const up = before.up[f] ? 1 : -1;
      lean[a] += s * up; lean[b] += s * up;
    }
    const bulge = Math.sin(Math.PI * t) * this.size * 0.08;
    const height = (state, v) => (state.heightOf ??= heightsOf(this.faces, state.level, where.length / 3))[v];
    before.at.forEach((p, v) => {
      const q = after.at[v];
      where[3 * v] = p[0] + (q[0] - p[0]) * t;
      where[3 * v + 1] = p[1] + (q[1] - p[1]) * t;
      where[3 * v + 2] = bulge * Math.sign(lean[v]) + gap * (height(before, v) * (1 - t) + height(after, v) * t);
    });
    const {ends, lengths} = bars, rounds = Math.round(Math.min(ROUNDS, Math.max(8, 90_000 / lengths.length)));
    let off = 0, all = 0;
    for (let round = 0; round <= rounds; round++) for (let at = 0; at < lengths.length; at++) {
      const a = ends[2 * at], b = ends[2 * at + 1];
      const dx = where[b] - where[a], dy = where[b + 1] - where[a + 1], dz = where[b + 2] - where[a + 2];
      const now = Math.sqrt(dx * dx + dy * dy + dz * dz) || 1e-9;
      if (round === rounds) { off += Math.abs(now - lengths[at]); all += lengths[at]; continue; }
      const move = (now - lengths[at]) / now / 2;
      where[a] += dx * move; where[a + 1] += dy * move; where[a + 2] += dz * move;
      where[b] -= dx * move; where[b + 1] -= dy * move; where[b + 2] -= dz * move;
    }
    return off / all;
  }
}

const dist = (p, q) => Math.hypot(p[0] - q[0], p[1] - q[1]);
const unit = (p, q) => { const d = dist(p, q) || 1; return [(q[0] - p[0]) / d, (q[1] - p[1]) / d]; };

function area(face, at) {
  let sum = 0;
  face.forEach((a, k) => { const b = face[(k + 1) % face.length]; sum += at[a][0] * at[b][1] - at[b][0] * at[a][1]; });
  return sum;
}

function middle(points) {
  return [0, 1].map((axis) => {
    let least = Infinity, most = -Infinity;
    for (const p of points) { least = Math.min(least, p[axis]); most = Math.max(most, p[axis]); }
    return (least + most) / 2;
  });
}

/** What finds the edge between two vertices, undefined where there is none. */
function finder({edges, flat}) {
  const key = (a, b) => Math.min(a, b) * flat.length + Math.max(a, b), of = new Map(edges.map(([a, b], e) => [key(a, b), e]));
  return (a, b) => of.get(key(a, b));
}

/** The faces beside each edge. */
export function besides(data) {
  const {faces, edges} = data, edgeOf = finder(data), beside = edges.map(() => []);
  faces.forEach((face, f) => face.forEach((a, k) => {
    const e = edgeOf(a, face[(k + 1) % face.length]);
    if (e !== undefined) beside[e].push(f);
  }));
  return beside;
}

/** The mean level of the faces at each vertex. */
function heightsOf(faces, level, count) {
  const sum = new Float64Array(count), times = new Float64Array(count), most = Math.max(...level);
  faces.forEach((face, f) => face.forEach((v) => { sum[v] += level[f] - most / 2; times[v] += 1; }));
  return sum.map((s, v) => s / Math.max(times[v], 1));
}

/** How many levels of paper lie under each face: faces joined by creases that are not folded yet are one piece. */
function levelsOf(faces, at, rank, beside, folded, size) {
  const piece = faces.map((_, f) => f);
  const find = (f) => { while (piece[f] !== f) f = piece[f] = piece[piece[f]]; return f; };
  beside.forEach((two, e) => { if (two.length === 2 && !folded.has(e)) piece[find(two[0])] = find(two[1]); });
  if (faces.length > 400) return piece.every((_, f) => find(f) === find(0)) ? rank.map(() => 0) : rank.slice();
  const shrunk = faces.map((face) => {
    const points = face.map((v) => at[v]), c = middle(points), keep = 1 - 1e-4;
    return points.map((p) => [c[0] + (p[0] - c[0]) * keep, c[1] + (p[1] - c[1]) * keep]);
  });
  const boxes = shrunk.map((points) => [Math.min(...points.map((p) => p[0])), Math.min(...points.map((p) => p[1])), Math.max(...points.map((p) => p[0])), Math.max(...points.map((p) => p[1]))]);
  const order = faces.map((_, f) => f).sort((f, g) => rank[f] - rank[g]);
  const above = new Map(), under = new Map();
  order.forEach((g, i) => {
    for (let j = 0; j < i; j++) {
      const f = order[j], a = find(f), b = find(g), p = boxes[f], q = boxes[g];
      if (a === b || p[0] > q[2] || q[0] > p[2] || p[1] > q[3] || q[1] > p[3] || !overlap(shrunk[f], shrunk[g], 1e-7 * size)) continue;
      if (!above.has(a)) above.set(a, new Set());
      if (!above.get(a).has(b)) { above.get(a).add(b); under.set(b, (under.get(b) || 0) + 1); }
    }
  });
  const pieces = new Set(faces.map((_, f) => find(f))), level = new Map([...pieces].map((p) => [p, 0]));
  const ready = [...pieces].filter((p) => !under.get(p));
  let done = 0;
  while (ready.length) {
    const a = ready.pop();
    done += 1;
    for (const b of above.get(a) || []) {
      level.set(b, Math.max(level.get(b), level.get(a) + 1));
      under.set(b, under.get(b) - 1);
      if (!under.get(b)) ready.push(b);
    }
  }
  return done === pieces.size ? faces.map((_, f) => level.get(find(f))) : rank.slice();
}

/** Whether two convex polygons share some area. */
export function overlap(one, other, least) {
  for (const [p, q] of [[one, other], [other, one]]) for (let k = 0; k < p.length; k++) {
    const a = p[k], b = p[(k + 1) % p.length], n = [b[1] - a[1], a[0] - b[0]], long = Math.hypot(...n) || 1;
    const reach = (points) => { let lo = Infinity, hi = -Infinity; for (const v of points) { const d = (v[0] * n[0] + v[1] * n[1]) / long; lo = Math.min(lo, d); hi = Math.max(hi, d); } return [lo, hi]; };
    const [lo, hi] = reach(p), [l, h] = reach(q);
    if (hi <= l + least || h <= lo + least) return false;
  }
  return true;
}

/** Each face in its parts inside and outside the shape; corners are (vertex, vertex, weight of the second). */
function partsOf({faces, folded}) {
  const parts = [];
  faces.forEach((face, f) => {
    for (const side of [1, -1]) {
      const corners = [];
      let most = 0;
      face.forEach((a, k) => {
        const b = face[(k + 1) % face.length], ha = side * folded[a][1], hb = side * folded[b][1];
        most = Math.max(most, ha);
        if (ha >= 0) corners.push([a, a, 0]);
        if ((ha > 0 && hb < 0) || (ha < 0 && hb > 0)) corners.push([a, b, ha / (ha - hb)]);
      });
      if (corners.length > 2 && most > 1e-9) parts.push({f, inside: side > 0, corners});
    }
  });
  return parts;
}

/** Lengths that paper keeps: edges, and diagonals of faces. */
function barsOf({faces, flat}) {
  const ends = [], lengths = [], seen = new Set();
  const add = (a, b) => {
    const key = Math.min(a, b) * flat.length + Math.max(a, b);
    if (a === b || seen.has(key)) return;
    seen.add(key);
    ends.push(3 * a, 3 * b);
    lengths.push(dist(flat[a], flat[b]));
  };
  for (const face of faces) face.forEach((a, k) => { add(a, face[(k + 1) % face.length]); add(face[0], a); add(a, face[(k + 2) % face.length]); });
  return {ends: Int32Array.from(ends), lengths: Float64Array.from(lengths)};
}
