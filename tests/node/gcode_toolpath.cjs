// Read G-code with gcode-toolpath and print its moves, [rapid, x1, y1, z1, x2, y2, z2] each, as JSON.
const Toolpath = require("gcode-toolpath");

const moves = [];
const toolpath = new Toolpath({
  addLine: (modal, from, to) => moves.push([modal.motion === "G0", from.x, from.y, from.z, to.x, to.y, to.z]),
  addArcCurve: () => {
    throw new Error("there are no arcs in our files");
  },
});
toolpath.loadFromFileSync(process.argv[2]);
console.log(JSON.stringify({ moves }));
