#include <accdec/plot/html_parts.hpp>

namespace accdec {

const std::string_view html_style = R"css(
body{font:16px/1.45 system-ui,sans-serif;max-width:76rem;margin:2rem auto;padding:0 1rem;color:#1a1a1a;background:#fff;
  overflow-wrap:break-word}
p,ul,summary{max-width:46rem}
h1{font-size:1.6rem}
table{border-collapse:collapse;margin:1rem 0}
td,th{border:1px solid #bbb;padding:.25rem .6rem;text-align:left;white-space:nowrap}
td.n{text-align:right;font-variant-numeric:tabular-nums}
.sorts th{cursor:pointer;position:sticky;top:0;background:#eee;white-space:nowrap}
.sorts th[aria-sort=ascending]::after{content:" \25b2"}
.sorts th[aria-sort=descending]::after{content:" \25bc"}
.wide{overflow:auto;max-width:100%}
.tall{max-height:32rem;overflow:auto}
figure{margin:2rem 0}
svg{max-width:100%;height:auto}
pre{overflow:auto;background:#f5f5f5;padding:.6rem}
details{margin:.8rem 0}
summary{cursor:pointer;font-weight:600}
canvas{display:block;width:100%;height:min(44rem,75vh,100vw);border:1px solid #ccc;box-sizing:border-box;
  touch-action:none;cursor:crosshair}
#speed{height:16rem;touch-action:pan-y}
#info{min-height:1.45em;font-variant-numeric:tabular-nums}
td.long{white-space:normal;min-width:16rem}
.stack{display:none}
.stack svg{display:block;width:100%}
.tip{position:fixed;pointer-events:none;background:#222;color:#fff;font-size:.85rem;padding:.3rem .5rem;
  border-radius:.25rem;white-space:pre;z-index:2}
@media (max-width:40rem){body{margin:.5rem auto;padding:0 .6rem}pre{white-space:pre-wrap}
table:not(.sorts) td,table:not(.sorts) th{white-space:normal;overflow-wrap:anywhere}
.stacked .wide{height:0;overflow:hidden}.stacked .stack{display:block}
table.cards,.cards tbody,.cards tr{display:block}.cards thead{display:none}
.cards tr{border:1px solid #bbb;margin:.5rem 0}
.cards td,.cards td.long{display:flex;justify-content:space-between;gap:1rem;min-width:0;border:0;text-align:right}
.cards td::before{content:attr(data-head);color:#555;text-align:left;flex:none}
.cards td:empty{display:none}
}
@media print{body{margin:0;max-width:none}.wide,.tall,pre{overflow:visible;max-height:none}pre{white-space:pre-wrap}
figure{break-inside:avoid}table{font-size:.7rem}td,th{padding:.15rem .3rem;white-space:normal}
.sorts th{white-space:normal;position:static}
.tip,.unprinted{display:none}}
)css";

// Values under the pointer: of the nearest point of a line, or of the cell, in the drawing's own pixels.
const std::string_view html_script = R"js("use strict";
(() => {
const tip = document.createElement("div");
tip.className = "tip"; tip.hidden = true;
document.body.append(tip);
const at = (scale, length, v) => scale.log
  ? length * (Math.log(v) - Math.log(scale.from)) / (Math.log(scale.to) - Math.log(scale.from))
  : length * (v - scale.from) / (scale.to - scale.from);
const nearest = (list, scale, length, p) => {
  let best = -1, least = Infinity;
  list.forEach((v, i) => { const d = Math.abs(at(scale, length, v) - p); if (d < least) { least = d; best = i; } });
  return best;
};
const told = (panel, label, x, y, more) => [label, panel.x.label + ": " + x, panel.y.label + ": " + y, more]
  .filter(Boolean).join("\n");
function find(panel, px, py) {
  const x = px - panel.left, y = panel.top + panel.height - py;
  if (x < -4 || y < -4 || x > panel.width + 4 || y > panel.height + 4) return null;
  if (panel.heat) {
    const h = panel.heat, i = nearest(h.x, panel.x, panel.width, x), j = nearest(h.y, panel.y, panel.height, y);
    const v = h.values[j * h.x.length + i];
    return v === null ? null : { text: told(panel, "", h.x[i], h.y[j], h.label + ": " + v) };
  }
  let best = null, least = 40 * 40;
  for (const s of panel.series) for (let i = 0; i < s.x.length; ++i) {
    const dx = at(panel.x, panel.width, s.x[i]) - x, dy = at(panel.y, panel.height, s.y[i]) - y, d = dx * dx + dy * dy;
    if (s.y[i] !== null && d < least) {
      least = d;
      best = { text: told(panel, "value" in s ? s.label + ": " + s.value : s.label, s.x[i], s.y[i]),
               x: x + dx + panel.left, y: panel.top + panel.height - y - dy };
    }
  }
  return best;
}
for (const figure of document.querySelectorAll("figure")) {
  const svg = figure.querySelector("svg"), data = figure.querySelector("script");
  if (!svg || !data) continue;
  const { title, panels, boxes } = JSON.parse(data.textContent);
  tells(svg, panels);
  if (boxes.length < 2) continue;
  // On a phone the panels stand below each other.
  const drawing = svg.querySelector("g"), stack = document.createElement("div");
  drawing.id = figure.id + "-drawing";
  stack.className = "stack";
  stack.append(Object.assign(document.createElement("p"), { textContent: title }));
  for (const box of boxes) {
    const one = drawn("svg", { viewBox: box.join(" ") });
    one.append(drawn("use", { href: "#" + drawing.id }));
    stack.append(one);
    tells(one, panels);
  }
  figure.append(stack);
  figure.classList.add("stacked");
}
function drawn(tag, look) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [k, v] of Object.entries(look)) element.setAttribute(k, v);
  return element;
}
function tells(svg, panels) {
  const ring = drawn("circle", { r: 6, fill: "none", stroke: "#000", "stroke-width": 2, visibility: "hidden" });
  svg.append(ring);
  const leave = () => { tip.hidden = true; ring.setAttribute("visibility", "hidden"); };
  const show = event => {
    const p = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const found = panels.map(panel => find(panel, p.x, p.y)).find(Boolean);
    if (!found) return leave();
    if (found.x !== undefined) {
      ring.setAttribute("cx", found.x); ring.setAttribute("cy", found.y);
    }
    ring.setAttribute("visibility", found.x === undefined ? "hidden" : "visible");
    tip.textContent = found.text; tip.hidden = false;
    const room = document.documentElement.clientWidth - tip.offsetWidth - 4;
    tip.style.left = Math.max(0, Math.min(event.clientX + 14, room)) + "px";
    tip.style.top = Math.max(0, event.clientY - tip.offsetHeight - 10) + "px";
  };
  svg.addEventListener("pointermove", show);
  svg.addEventListener("pointerdown", show);
  svg.addEventListener("pointerleave", leave);
}
for (const table of document.querySelectorAll("table.sorts")) {
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, c) => head.addEventListener("click", () => {
    const down = head.getAttribute("aria-sort") === "ascending", body = table.tBodies[0];
    heads.forEach(other => other.removeAttribute("aria-sort"));
    head.setAttribute("aria-sort", down ? "descending" : "ascending");
    const key = row => row.cells[c].textContent;
    const compare = (a, b) => {
      const s = key(a), t = key(b), m = Number(s), n = Number(t);
      if (s === "" || t === "") return (s === "") - (t === "");  // what is not there stays last
      const order = isNaN(m) || isNaN(n) ? s.localeCompare(t) : m - n;
      return down ? -order : order;
    };
    body.append(...[...body.rows].sort(compare));
  }));
}
let folded = [];
addEventListener("beforeprint", () => {
  folded = [...document.querySelectorAll("details:not([open])")];
  folded.forEach(d => d.open = true);
});
addEventListener("afterprint", () => folded.forEach(d => d.open = false));
})();
)js";

}  // namespace accdec
