// What rabbit-ear makes of a FOLD file: node rabbit_ear.cjs FILE.fold [local] -> JSON on stdout.
// "local" leaves the layers out, which take long with thousands of faces.
// Only the file's creases go in; faces, folded coordinates, single-vertex conditions and layer constraints are
// rabbit-ear's own. The file's faceOrders are then put to the constraints.
const fs = require("fs");
const ear = require("rabbit-ear");

const EPSILON = 1e-6; // mm and radians

const file = JSON.parse(fs.readFileSync(process.argv[2], "utf8"));
const { vertices_coords, edges_vertices, edges_assignment, faces_vertices } = file;
const bare = { vertices_coords, edges_vertices, edges_assignment };

// The faces of the plane graph, the outer one left out.
const planar = ear.graph.populate({ ...bare });

const creases = ear.graph.populate({ ...bare, faces_vertices });
const folded_coords = ear.graph.makeVerticesCoordsFlatFolded(creases, 0);

const local = {
  planar_faces: planar.faces_vertices.length,
  validate: ear.graph.validate({ ...bare, faces_vertices }).summary,
  kawasaki: ear.singleVertex.validateKawasaki(creases, EPSILON),
  maekawa: ear.singleVertex.validateMaekawa(creases),
  folded_coords,
};
if (process.argv[3] === "local") {
  console.log(JSON.stringify(local));
  return;
}

const folded = { ...creases, vertices_coords: folded_coords };
const upright = ear.graph.makeFacesWinding(folded);

// "f g", f < g -> 1 when f lies over g, seen from where counter-clockwise folded faces show their front; else 2.
const orders = {};
file.faceOrders.forEach(([f, g, s]) => {
  const over = upright[g] === (s > 0);
  orders[f < g ? `${f} ${g}` : `${g} ${f}`] = over === f < g ? 1 : 2;
});
const orderOf = ([f, g]) => {
  const order = orders[f < g ? `${f} ${g}` : `${g} ${f}`];
  return order === undefined || f < g ? order : 3 - order;
};

// The pairs of faces whose orders make up the key of a constraint in rabbit-ear's tables.
const pairsOf = {
  taco_taco: ([a, b, c, d]) => [[a, c], [b, d], [b, c], [a, d], [a, b], [c, d]],
  taco_tortilla: ([a, b, c]) => [[a, c], [a, b], [b, c]],
  tortilla_tortilla: ([a, b, c, d]) => [[a, c], [b, d]],
  transitivity: ([a, b, c]) => [[a, b], [b, c], [c, a]],
};
const found = ear.layer.makeTacosTortillas(folded, EPSILON);
const constraints = {
  taco_taco: found.taco_taco.map(([[a, b], [c, d]]) => [a, c, b, d]),
  taco_tortilla: found.taco_tortilla.map(({ taco, tortilla }) => [taco[0], tortilla, taco[1]]),
  tortilla_tortilla: found.tortilla_tortilla.map(([[a, b], [c, d]]) => [a, b, c, d]),
  // Cubic in the number of faces.
  transitivity: faces_vertices.length > 150 ? [] : ear.layer.makeTransitivityTrios(folded, undefined, upright, EPSILON),
};
const layers = {};
Object.entries(constraints).forEach(([type, list]) => {
  const count = { checked: list.length, violated: 0, unordered: 0 };
  list.forEach((faces) => {
    const key = pairsOf[type](faces).map(orderOf);
    if (key.includes(undefined)) count.unordered += 1;
    else if (ear.layer.table[type][key.join("")] !== true) count.violated += 1;
  });
  layers[type] = count;
});

// Mountains and valleys fix the order of neighbours; rabbit-ear computes them from the assignment alone.
const neighbours = ear.layer.solveEdgeAdjacentFacePairs(folded, Object.keys(orders), upright);
const overlapping = ear.layer.makeFacePairs(folded, ear.graph.makeFacesFacesOverlap(folded, EPSILON));

console.log(JSON.stringify({
  ...local,
  layers,
  neighbours: Object.keys(neighbours).length,
  neighbours_wrong: Object.keys(neighbours).filter((key) => neighbours[key] !== orders[key]).length,
  overlaps_unordered: overlapping.filter((key) => orders[key] === undefined).length,
  orders: Object.keys(orders).length,
}));
