// Words and small helpers that all parts of the page use.

export const $ = (id) => document.getElementById(id);

export const number = (count, one, many = `${one}s`) => `${count} ${count === 1 ? one : many}`;

/** Make an element of HTML with attributes and children; strings become text, never markup. */
export function make(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value === true) made.setAttribute(key, "");
    else if (value !== false && value !== null) made.setAttribute(key, value);
  }
  made.append(...children);
  return made;
}

const NS = "http://www.w3.org/2000/svg";

/** Add an element of SVG to a parent. */
export function put(parent, name, attributes = {}) {
  const made = document.createElementNS(NS, name);
  for (const key in attributes) made.setAttribute(key, attributes[key]);
  parent?.append(made);
  return made;
}

/** The path of loops of points whose y axis goes up, on a sheet of this height. */
export const pathOf = (loops, height) =>
  loops.map((loop) => "M" + loop.map(([x, y]) => `${x} ${height - y}`).join("L") + "Z").join("");

/** Save text or a blob as a file of this name. */
export function save(name, content, type) {
  const link = make("a", {href: URL.createObjectURL(content instanceof Blob ? content : new Blob([content], {type})), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}

/** A name that every system takes as the beginning of a file's name. */
export const fileStem = (title) => title.replace(/[^\p{L}\p{N} ._-]+/gu, "-").replace(/^[.\s-]+/, "").slice(0, 60).trim() || "pattern";
