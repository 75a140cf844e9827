// What the FOLD specification's own package makes of a file: node fold_package.cjs FILE.fold -> JSON on stdout.
const fs = require("fs");
const FOLD = require("fold");

const file = JSON.parse(fs.readFileSync(process.argv[2], "utf8"));
const { vertices_coords, edges_vertices, edges_assignment } = file;
const bare = () => FOLD.convert.deepCopy({ vertices_coords, edges_vertices, edges_assignment });

// In micrometres: the package takes edges shorter than 0.001 for points.
const fine = bare();
fine.vertices_coords = fine.vertices_coords.map((point) => point.map((x) => 1000 * x));
const faces = FOLD.convert.edges_vertices_to_faces_vertices(fine);
// The file's own faces, so that face 0 is the same in both.
const folded = { ...bare(), faces_vertices: file.faces_vertices };
FOLD.convert.faces_vertices_to_faces_edges(folded);
folded.edges_faces = folded.edges_vertices.map(() => []);
folded.faces_edges.forEach((edges, face) => edges.forEach((edge) => folded.edges_faces[edge].push(face)));
folded.edges_faces.forEach((pair) => { while (pair.length < 2) pair.push(null); });
const closure_error = FOLD.convert.flatFoldedGeometry(folded, 0);

console.log(JSON.stringify({
  faces: faces.faces_vertices.length,
  closure_error,
  folded_coords: folded.vertices_flatFoldCoords,
  turned: folded.faces_flatFoldOrientation.map((sign) => sign < 0),
}));
