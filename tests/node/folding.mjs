// How the page moves each pattern (JSON files): prints per straight fold what is off and which faces would cross.
import fs from "node:fs";
import {Folding, overlap} from "../../page/src/folding.js";

const shrunk = (face, at) => {
  const points = face.map((v) => at[v]), c = [0, 1].map((i) => points.reduce((sum, p) => sum + p[i], 0) / points.length);
  return points.map((p) => p.map((x, i) => c[i] + (x - c[i]) * (1 - 1e-4)));
};

/** Pairs of faces that lie on each other in a state. */
function pairs(folding, state) {
  const faces = folding.faces.map((face) => shrunk(face, state.at)), found = [];
  for (let f = 0; f < faces.length; f++) for (let g = f + 1; g < faces.length; g++) if (overlap(faces[f], faces[g], 1e-6 * folding.size)) found.push([f, g]);
  return found;
}

function look(data) {
  const folding = new Folding(data), seen = {straight: 0, together: 0, longest: 0, crossings: 0, jump: 0, through: 0, off: 0};
  folding.steps.forEach((step, k) => {
    const before = folding.states[k], after = folding.states[k + 1];
    if (!step.line) { seen.together += 1; seen.off = Math.max(seen.off, ...[0.25, 0.5, 0.75].map((t) => folding.place(k + t, 0).off)); return; }
    seen.straight += 1;
    const moved = new Set(step.moved), turns = new Set(step.moved.flatMap((f) => data.faces[f]));
    for (const t of [0.1, 0.5, 0.9]) {
      folding.place(k + t, 0);
      const {where, bars: {ends, lengths}} = folding;
      lengths.forEach((long, i) => {
        const [a, b] = [ends[2 * i], ends[2 * i + 1]];
        seen.longest = Math.max(seen.longest, Math.abs(long - Math.hypot(...[0, 1, 2].map((d) => where[b + d] - where[a + d]))));
      });
      data.flat.forEach((_, v) => { // what moves stays on its side of the sheet
        const z = where[3 * v + 2] * (step.over ? 1 : -1);
        if (z < -1e-3 || (!turns.has(v) && z !== 0)) seen.through += 1;
      });
    }
    for (const [state, turned] of [[before, 1], [after, -1]]) for (const [f, g] of pairs(folding, state)) {
      const higher = state.rank[f] > state.rank[g];
      if (moved.has(f) !== moved.has(g) && higher !== (moved.has(f) === step.over)) seen.crossings += 1;
      if (moved.has(f) === moved.has(g) && turned > 0 && (after.rank[f] > after.rank[g]) !== (higher !== moved.has(f))) seen.crossings += 1;
    }
    folding.place(k + 1 - 1e-9, 0);
    after.at.forEach((p, v) => { seen.jump = Math.max(seen.jump, Math.hypot(p[0] - folding.where[3 * v], p[1] - folding.where[3 * v + 1])); });
  });
  return seen;
}

console.log(JSON.stringify(process.argv.slice(2).map((file) => look(JSON.parse(fs.readFileSync(file, "utf8"))))));
