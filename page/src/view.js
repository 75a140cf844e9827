// The page of foldcut view: one pattern, which is in the page.
import {facts} from "./pattern.js";
import {FOLDED_PANE, PATTERN_PANE, Viewer} from "./viewer.js";
import {$} from "./words.js";

export function startView() {
  const data = JSON.parse($("data").textContent);
  $("app").innerHTML = `<section class="pane" aria-labelledby="h-pattern">${PATTERN_PANE}</section><section class="pane" aria-labelledby="h-folded">${FOLDED_PANE}</section>`;
  document.title = `${data.title} – foldcut`;
  $("title").textContent = data.title;
  $("facts").textContent = facts(data);
  const viewer = new Viewer();
  viewer.show(data);
  $("print").onclick = () => window.print();
  $("save-svg").onclick = () => viewer.saveSvg();
  $("save-png").onclick = () => viewer.savePicture();
  $("save-png").hidden = !viewer.scene;
  performance.mark("drawn");
}
