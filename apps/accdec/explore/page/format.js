// Numbers and elements as people read them.

/** An element of the page. */
export const $ = (selector) => document.querySelector(selector);

/** s; the time that a result's task minimises. */
export const objective = (result) =>
  result.task.design?.objective === "corner" ? result.corner_time_s : result.cycle_time_s;

/** The filter in use today: where a task names families of settings, its [filter] is that. */
export const filterOfToday = (task) => task.baseline ?? (task.design?.family ? task.filter : undefined);

/** Four digits, without zeros behind them. */
export const four = (x) => (Number.isFinite(x) ? String(Number(x.toPrecision(4))).replace("-", "\u2212") : "\u2013");

/** s over a program: samples that follow each other differ. */
export const instant = (seconds) => String(Number(seconds.toFixed(5)));

/** s as ms, to the microsecond. */
export const ms = (seconds) => String(Number((1e3 * seconds).toFixed(6))).replace("-", "\u2212");

/** Axes of these names turn: they are in degrees where others are in mm. */
export const lengthUnit = (axis) => (/^[abc]$/i.test(axis) ? "deg" : "mm");

/** "mm/s^2" as it is printed. */
export const unit = (text) =>
  text.replaceAll("^2", "\u00b2").replaceAll("^3", "\u00b3").replace(/\bum\b/g, "\u00b5m");

/** An element: attributes, then children, which are elements or texts. */
export function make(tag, attributes = {}, ...children) {
  const svg = ["svg", "path", "circle", "ellipse", "line", "text", "g", "rect", "polyline", "title"].includes(tag);
  const element = svg ? document.createElementNS("http://www.w3.org/2000/svg", tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== undefined && value !== null) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

const most_columns = 5; // of a table on a phone
const longest_line = 60; // characters of a cell; a longer text has several lines

/**
 * Rows of cells, each a text or an element. Numbers stand at the right, and so do columns `right`. On a phone the cells
 * of a row of many stand below each other, each with its heading.
 */
export function table(head, rows, { right = [], ...attributes } = {}) {
  const cards = head.filter(Boolean).length > most_columns;
  const kind = (content) => {
    if (typeof content !== "string") return undefined;
    return /^([\u2212+]?[\d.]+( %)?|\u2013)$/.test(content) ? "n" : content.length > longest_line ? "long" : undefined;
  };
  const cell = (tag, content, i) =>
    make(
      tag,
      {
        class: right.includes(i) ? "n" : kind(content),
        "data-head": cards ? head[i] : undefined,
      },
      content ?? "",
    );
  return make(
    "table",
    { class: cards ? "cards" : undefined, ...attributes },
    make("thead", {}, make("tr", {}, ...head.map((text) => make("th", {}, text)))),
    make(
      "tbody",
      {},
      ...rows.map((row) => {
        const cells = (row.cells ?? row).map((content, i) => cell("td", content, i));
        return make("tr", row.attributes ?? {}, ...cells);
      }),
    ),
  );
}
