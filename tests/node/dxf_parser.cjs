// Read a DXF file with dxf-parser and print its unit and strokes by layer as JSON.
const fs = require("fs");
const DxfParser = require("dxf-parser");

const drawing = new DxfParser().parseSync(fs.readFileSync(process.argv[2], "utf8"));
const layers = {};
for (const entity of drawing.entities) {
  const points = entity.vertices.map((vertex) => [vertex.x, vertex.y]);
  if (entity.shape) points.push(points[0]);
  (layers[entity.layer] ??= []).push(points);
}
console.log(JSON.stringify({ unit: drawing.header?.$INSUNITS ?? null, layers }));
