#include <accdec/plot/html_parts.hpp>

namespace accdec {

// Lengths are CSS pixels; a canvas has as many dots as its screen, so that text stays sharp and of one size.
const std::string_view program_script = R"js("use strict";
const P = document.getElementById("path"), S = document.getElementById("speed"), info = document.getElementById("info");
const N = D.t.length, end = D.t[N - 1];
// Colours and the scale of speeds are for cutting: of rapid moves that are faster they say only that.
const fastest = D.v.filter(isFinite).reduce((a, b) => Math.max(a, b), 1e-9);
const top_ = D.feed > 0 ? Math.min(D.feed, fastest) : fastest;
const speed = v => Number(v.toPrecision(3));
// Colours come with the data: of limits, and of speeds as "0 '#rrggbb', .., 1 '#rrggbb'".
const stops = [...D.palette.matchAll(/([\d.]+) '#(..)(..)(..)'/g)].map(
  ([, at, ...hex]) => [Number(at), hex.map(h => parseInt(h, 16))]);
function hue(q) {
  q = Math.min(1, Math.max(0, q));
  const i = Math.max(1, stops.findIndex(s => s[0] >= q)), [from, a] = stops[i - 1], [to, b] = stops[i];
  return `rgb(${a.map((c, n) => Math.round(c + (q - from) / (to - from) * (b[n] - c)))})`;
}
// The path as drawn, mm. A program that only drills shows its depth over a time that makes it half as high as wide.
const seen = row => D.t.map((_, i) => D.rows[row].reduce((sum, c, a) => sum + (c ? c * D.p[a][i] : 0), 0));
const Y = seen(1);
let y0 = Infinity, y1 = -Infinity;
for (const y of Y) { y0 = Math.min(y0, y); y1 = Math.max(y1, y); }
const second = D.over ? 2 * Math.max(1e-6, y1 - y0) / end : 0;  // mm
const X = D.over ? D.t.map(t => t * second) : seen(0);
let x0 = Infinity, x1 = -Infinity;
for (const x of X) { x0 = Math.min(x0, x); x1 = Math.max(x1, x); }
// 1, 2 or 5 times a power of ten: the largest that is no larger.
const round = x => {
  const ten = Math.pow(10, Math.floor(Math.log10(x) + 1e-9));
  return [5, 2, 1].map(m => m * ten).find(m => m <= x * (1 + 1e-9));
};
// Scale (px a mm), the point in the middle, the times at both ends, the sample that is told.
let k = 1, cx = (x0 + x1) / 2, cy = (y0 + y1) / 2, ta = 0, tb = end, mark = -1;
const px = i => P.clientWidth / 2 + (X[i] - cx) * k, py = i => P.clientHeight / 2 - (Y[i] - cy) * k;
const left = 64, low = 34;
const sx = i => left + (D.t[i] - ta) / (tb - ta) * (S.clientWidth - left - 12);
const sy = v => S.clientHeight - low - v / top_ * (S.clientHeight - low - 14);
function pen(c) {
  const q = window.devicePixelRatio || 1, w = Math.round(c.clientWidth * q), h = Math.round(c.clientHeight * q);
  if (c.width !== w || c.height !== h) { c.width = w; c.height = h; }
  const g = c.getContext("2d");
  g.setTransform(q, 0, 0, q, 0, 0);
  g.clearRect(0, 0, c.clientWidth, c.clientHeight);
  g.font = "12px system-ui,sans-serif";
  g.lineCap = "round"; g.textAlign = "left";
  return g;
}
function stroke(g, colour, width, a, b, c, d) {
  g.strokeStyle = colour; g.lineWidth = width;
  g.beginPath(); g.moveTo(a, b); g.lineTo(c, d); g.stroke();
}
function drawPath() {
  const g = pen(P), w = P.clientWidth, h = P.clientHeight;
  for (let i = 1; i < N; i++) {
    const a = px(i - 1), b = py(i - 1), c = px(i), d = py(i);
    if (Math.max(a, c) < 0 || Math.min(a, c) > w || Math.max(b, d) < 0 || Math.min(b, d) > h) continue;
    stroke(g, hue(D.v[i] / top_), 2, a, b, c, d);
  }
  if (mark >= 0) { g.fillStyle = "#000"; g.beginPath(); g.arc(px(mark), py(mark), 5, 0, 7); g.fill(); }
  const bar = round(150 / k / (second || 1)), wide = bar * (second || 1) * k;
  g.fillStyle = "#ffffffcc";
  g.fillRect(6, h - 34, wide + 12, 28); g.fillRect(w - 178, 6, 172, top_ < fastest ? 52 : 36);
  g.fillStyle = "#000";
  g.fillText(`${Number(bar.toPrecision(3))} ${D.over ? "s" : "mm"}`, 12, h - 18);
  stroke(g, "#000", 1, 12, h - 12, 12 + wide, h - 12);
  if (D.over) {
    const mm = round(100 / k);
    stroke(g, "#000", 1, 12, h - 40, 12, h - 40 - mm * k);
    g.fillText(`${Number(mm.toPrecision(3))} mm`, 18, h - 40 - mm * k / 2);
  }
  for (let i = 0; i < 160; i++) { g.fillStyle = hue(i / 160); g.fillRect(w - 172 + i, 12, 1, 10); }
  g.fillStyle = "#000"; g.fillText("0", w - 172, 36);
  g.textAlign = "right"; g.fillText(`${speed(top_)} mm/s`, w - 12, 36);
  if (top_ < fastest) g.fillText(`at most ${speed(fastest)} mm/s`, w - 12, 52);
}
function drawSpeed() {
  const g = pen(S), w = S.clientWidth, h = S.clientHeight;
  g.save(); g.beginPath(); g.rect(left, 8, w - left - 12, h - low - 7); g.clip();
  for (let i = 1; i < N; i++) {
    if (D.t[i] < ta || D.t[i - 1] > tb) continue;
    stroke(g, D.l[i] < 0 ? D.grey : D.colours[D.l[i]], 1.5, sx(i - 1), sy(D.v[i - 1]), sx(i), sy(D.v[i]));
  }
  if (mark >= 0) stroke(g, "#000", 1, sx(mark), 8, sx(mark), h - low);
  g.restore();
  stroke(g, "#000", 1, left, 8, left, h - low); stroke(g, "#000", 1, left, h - low, w - 12, h - low);
  g.fillStyle = "#000"; g.fillText("mm/s", 6, 14);
  const parts = w < 500 ? 2 : 4;
  g.textAlign = "right";
  const ten = Math.pow(10, Math.floor(Math.log10(top_ / 4)));
  const step = [1, 2, 5, 10].map(m => m * ten).find(m => 5 * m >= top_);
  for (let v = 0; v <= top_; v += step) g.fillText(speed(v), left - 6, Math.max(26, sy(v) + 4));
  const tick = round(2 * (tb - ta) / parts);
  g.textAlign = "center";
  for (let n = Math.ceil(ta / tick - 1e-9); n * tick <= tb * (1 + 1e-9); n++) {
    const x = left + (n * tick - ta) / (tb - ta) * (w - left - 12), text = `${Number((n * tick).toPrecision(12))} s`;
    stroke(g, "#000", 1, x, h - low, x, h - low + 4);
    g.fillText(text, Math.min(x, w - 4 - g.measureText(text).width / 2), h - 14);
  }
}
function tell() {
  const places = D.ax.map((a, i) => `${a} ${D.p[i][mark]}`).join(", ");
  info.textContent = mark < 0 ? "\u00a0" : `${D.t[mark]} s: ${places} mm, ` +
    `${D.v[mark]} mm/s, ` + (D.l[mark] < 0 ? D.other : D.names[D.l[mark]]) + " binds";
}
let asked = false;
function draw() {
  tell();
  if (asked) return;
  asked = true;
  requestAnimationFrame(() => { asked = false; drawPath(); drawSpeed(); });
}
function home() {
  // Below the scale of colours, above that of lengths.
  k = Math.min((P.clientWidth - 40) / Math.max(1e-6, x1 - x0), (P.clientHeight - 110) / Math.max(1e-6, y1 - y0));
  cx = (x0 + x1) / 2; cy = (y0 + y1) / 2 + 12 / k; ta = 0; tb = end;
  draw();
}
function at(e, c) {
  const r = c.getBoundingClientRect();
  return [e.clientX - r.left - c.clientLeft, e.clientY - r.top - c.clientTop];
}
/// The point under (a, b) stays there.
function zoom(a, b, factor) {
  const u = cx + (a - P.clientWidth / 2) / k, w = cy - (b - P.clientHeight / 2) / k;
  k *= factor; cx = u - (a - P.clientWidth / 2) / k; cy = w + (b - P.clientHeight / 2) / k;
}
const held = new Map();
function near(a, b) {
  let best = 225;
  mark = -1;
  for (let i = 0; i < N; i++) {
    const q = (px(i) - a) ** 2 + (py(i) - b) ** 2;
    if (q < best) { best = q; mark = i; }
  }
}
P.addEventListener("wheel", e => {
  e.preventDefault();
  zoom(...at(e, P), Math.exp(-e.deltaY * 0.0015));
  draw();
}, { passive: false });
P.addEventListener("pointerdown", e => {
  P.setPointerCapture(e.pointerId);
  held.set(e.pointerId, at(e, P));
  near(...at(e, P));
  draw();
});
P.addEventListener("pointermove", e => {
  const now = at(e, P), before = held.get(e.pointerId);
  if (!before) { near(...now); return draw(); }
  const other = [...held].find(([id]) => id !== e.pointerId)?.[1];
  held.set(e.pointerId, now);
  if (other) {
    const far = p => Math.hypot(p[0] - other[0], p[1] - other[1]);
    zoom((now[0] + other[0]) / 2, (now[1] + other[1]) / 2, far(now) / Math.max(1, far(before)));
  }
  const share = other ? 2 : 1;  // of two fingers each moves half
  cx -= (now[0] - before[0]) / k / share; cy += (now[1] - before[1]) / k / share;
  draw();
});
for (const kind of ["pointerup", "pointercancel"]) P.addEventListener(kind, e => held.delete(e.pointerId));
S.addEventListener("wheel", e => {
  e.preventDefault();
  const u = ta + (at(e, S)[0] - left) / (S.clientWidth - left - 12) * (tb - ta), f = Math.exp(e.deltaY * 0.0015);
  ta = Math.max(0, u + (ta - u) * f); tb = Math.min(end, u + (tb - u) * f);
  draw();
}, { passive: false });
function nearTime(e) {
  const t = ta + (at(e, S)[0] - left) / (S.clientWidth - left - 12) * (tb - ta);
  let lo = 0, hi = N - 1;
  while (hi - lo > 1) { const m = (lo + hi) >> 1; if (D.t[m] < t) lo = m; else hi = m; }
  mark = hi;
  draw();
}
S.addEventListener("pointermove", nearTime);
S.addEventListener("pointerdown", nearTime);
P.ondblclick = S.ondblclick = home;
addEventListener("resize", draw);
document.getElementById("legend").innerHTML = D.names.map((n, i) => D.l.includes(i)
  ? `<b style="color:${D.colours[i]}">&#9632;</b> ${n} ` : "").join("") +
  `<b style="color:${D.grey}">&#9632;</b> ${D.other}`;
home();
)js";

}  // namespace accdec
