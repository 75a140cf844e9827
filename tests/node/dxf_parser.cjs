// Read DXF files with dxf-parser and print the unit and strokes by layer of each as JSON.
const fs = require("fs");
const DxfParser = require("dxf-parser");

const read = (path) => {
  const drawing = new DxfParser().parseSync(fs.readFileSync(path, "utf8"));
  const layers = {};
  for (const entity of drawing.entities) {
    const points = entity.vertices.map((vertex) => [vertex.x, vertex.y]);
    if (entity.shape) points.push(points[0]);
    (layers[entity.layer] ??= []).push(points);
  }
  return { unit: drawing.header?.$INSUNITS ?? null, layers };
};
console.log(JSON.stringify(process.argv.slice(2).map(read)));
