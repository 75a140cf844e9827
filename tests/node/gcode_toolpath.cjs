// Read G-code files with gcode-toolpath and print the moves of each, [rapid, x1, y1, z1, x2, y2, z2], as JSON.
const Toolpath = require("gcode-toolpath");

const read = (path) => {
  const moves = [];
  const toolpath = new Toolpath({
    addLine: (modal, from, to) => moves.push([modal.motion === "G0", from.x, from.y, from.z, to.x, to.y, to.z]),
    addArcCurve: () => {
      throw new Error("there are no arcs in our files");
    },
  });
  toolpath.loadFromFileSync(path);
  return moves;
};
console.log(JSON.stringify(process.argv.slice(2).map(read)));
