// Bundle src/ into page.js and page.css beside the exporter that writes them into a page.
import {build} from "esbuild";
import {readFileSync} from "node:fs";

const licence = readFileSync("node_modules/three/LICENSE", "utf8").replaceAll("*/", "").trim();
const shared = {bundle: true, minify: true, charset: "utf8", target: "es2021", logLevel: "info"};
await build({
  ...shared,
  entryPoints: ["src/page.js"],
  outfile: "../exporters/pattern/page.js",
  format: "iife",
  legalComments: "none",
  banner: {js: `/*! foldcut's page, with three.js:\n${licence}\n*/`},
});
await build({...shared, entryPoints: ["src/page.css"], outfile: "../exporters/pattern/page.css"});
