// The page of a program: its path by speed, everything over time, where time is lost, one plan against the other.
import { cornerText, openCorner } from "./corner.js";
import { cornerList } from "./corner_list.js";
import { $, four, instant, lengthUnit, make, table } from "./format.js";
import { showUndo, undoByKeys } from "./history.js";
import { fit, fitPaper, nearestTo, timeCharts, zoomTo } from "./over_time.js";
import { begin, stayAlive } from "./requests.js";
import { baseName, frozen, Saving } from "./save.js";
import { Scene } from "./scene.js";
import { Shades } from "./shades.js";
import { Shown } from "./shown.js";
import { taskAddress } from "./state.js";

// First of all: the program ends once no page tells that it is open.
stayAlive((gone) => document.body.classList.toggle("gone", gone));
const start = await begin();
const { program } = start;
const shown = { plan: 0, mark: -1, limits: false };
const seconds = (s) => `${Number(s.toFixed(3))} s`;
const charts = [];
const shades = new Shades(program.palette);

/** The plan that stands beside another: the slowest one, and beside that the fastest. */
const besides = (plan) => [program.plans.at(-1), program.plans[0]].find((p) => p !== plan);

const colourOf = (limit) => (limit < 0 ? program.other_colour : program.colours[limit]);

/** The names of the limits that bind somewhere, each with its colour. */
const limitsKey = (plan) =>
  [...new Set(plan.binds)].map((i) => {
    const swatch = make("svg", { class: "swatch", viewBox: "0 0 10 10", "aria-hidden": "true" });
    swatch.append(make("rect", { width: 10, height: 10, fill: colourOf(i) }));
    return make("span", {}, swatch, ` ${i < 0 ? program.other : program.limits[i]} `);
  });

/** The address that a corner opens: the explorer with the corner as its task, at the feeds of plan fixed. */
const addressOf = ({ corner, planned }) =>
  `index.html${taskAddress({ ...program.base, corner: [corner] })}${planned ? "&planned=true" : ""}`;

/** "3000", or "3000, 1500" where they differ */
const feedsText = (feeds) => [...new Set(feeds.map(four))].join(", ");
const feedsOf = ({ corner }) => feedsText([corner.feed_in_mm_min, corner.feed_out_mm_min]);

/** What a corner is opened with. */
function cornerTitle(corner) {
  const [now, asked] = [feedsOf(corner), feedsText(corner.programmed_mm_min)];
  const feeds = corner.planned ? `the feeds of plan fixed: ${now}` : `the programmed feeds: ${asked}`;
  const programmed = now === asked ? "" : ` (programmed: ${asked})`;
  return `The corner of line ${corner.line} by itself, from rest to rest at ${feeds} mm/min${programmed}`;
}

/** The corner nearest to a place. @param at  the place of a corner at so many mm */
const nearestCorner = (at, place, reach = Infinity) =>
  scene.nearest(program.corners.length, (i) => at(program.corners[i].at_mm), place, reach);
const drawnAt = (mm) => scene.at(mm);
const clicked = (place) => choose(nearestCorner(drawnAt, place, 15));
const scene = new Scene($("#path canvas"), showMark, clicked, (view) => state.set({ view }));
const state = new Shown(show);

/** Opens a corner above the path; below 0: none. */
function choose(i) {
  if (i < 0) return;
  state.set({ corner: String(i) });
  $("#corner").scrollIntoView();
}

/** By a key: the corner nearest to the cursor; without one, that which is open, or the one in the middle. */
function enter() {
  const { clientWidth, clientHeight } = scene.canvas;
  const places = program.plans[shown.plan].places_mm.map((axis) => axis[shown.mark]);
  if (shown.mark >= 0) choose(nearestCorner((mm) => mm, places));
  else if (program.corners[state.now.corner]) choose(Number(state.now.corner));
  else choose(nearestCorner(drawnAt, [clientWidth / 2, clientHeight / 2]));
}
for (const place of ["#path canvas", "#over-time"])
  $(place).addEventListener("keydown", (event) => event.key === "Enter" && enter());

function tell(i) {
  shown.mark = scene.mark = i;
  const plan = program.plans[shown.plan];
  scene.draw();
  if (i < 0) $("#info").textContent = "\u00a0";
  else sayWhere(plan, i);
  for (const chart of charts) {
    if (chart === follow.from) continue; // its cursor is there already
    const left = i < 0 ? -10 : chart.valToPos(plan.t_s[i], "x");
    chart.setCursor({ left, top: i < 0 ? -10 : Math.max(0, chart.cursor.top ?? 0) }, false);
  }
}

/** The sample's numbers, as the legends of the charts have them. */
function sayWhere(plan, i) {
  const place = (name, a) => `${name} ${four(plan.places_mm[a][i])} ${lengthUnit(name)}`;
  const places = program.axes.map(place).join(", ");
  const limit = plan.binds[i] < 0 ? program.other : program.limits[plan.binds[i]];
  $("#info").textContent = `${instant(plan.t_s[i])} s: ${places}, ${four(plan.speed_mm_s[i])} mm/s; ${limit} binds`;
}

function drawPath() {
  const plan = program.plans[shown.plan];
  shades.fit(plan.speed_mm_s);
  const bySpeed = (i) => shades.of(plan.speed_mm_s[i]);
  const colour = shown.limits ? (i) => colourOf(plan.binds[i]) : bySpeed;
  const lines = [{ places: plan.places_mm.slice(0, 3), colour, width: 2 }];
  scene.show(lines, program.corners.length <= 300 ? program.corners.map((c) => c.at_mm.slice(0, 3)) : []);
  $("#path h2").textContent = shown.limits
    ? "path in the colour of the limit that binds"
    : "path in the colour of its speed";
  $("#path-key").replaceChildren(...(shown.limits ? limitsKey(plan) : [shades.bar()]));
}

/** Charts of all quantities; those of the other plan in grey below. All have one cursor. */
function drawTime() {
  for (const chart of charts.splice(0)) chart.destroy();
  const plan = program.plans[shown.plan],
    before = besides(plan);
  let made = false;
  const ranged = (time) => (made ? state.set({ time }) : state.correct({ time }));
  setTimeout(() => (made = true));
  const { time } = state.now;
  charts.push(...timeCharts($("#over-time"), program, { plan, before, follow, sample, step, bars, time, ranged }));
}

/** The sample that the path and all charts tell about; while one chart moves, it is that of its cursor. */
const sample = (t) => (follow.busy ? shown.mark : nearestTo(program.plans[shown.plan].t_s, t));

/** The cursor over time moves the mark on the path, and the cursors of the other charts. */
function follow(chart) {
  if (!(chart.cursor.left >= 0)) return showMark(shown.mark);
  showMark(nearestTo(program.plans[shown.plan].t_s, chart.posToVal(chart.cursor.left, "x")), chart);
}
/** @param from  the chart whose cursor stands there already */
function showMark(i, from) {
  if (follow.busy) return;
  Object.assign(follow, { busy: true, from });
  shown.mark = i;
  tell(i);
  state.correct({ at: i < 0 ? "" : instant(program.plans[shown.plan].t_s[i]) });
  Object.assign(follow, { busy: false, from: null });
}
/** By keys: within what is shown of the time. */
function step(way, { min, max }) {
  const times = program.plans[shown.plan].t_s;
  const inside = (i, way) => (way * (times[i] - (way > 0 ? min : max)) < 0 ? i + way : i);
  const first = inside(nearestTo(times, min), 1),
    last = Math.max(first, inside(nearestTo(times, max), -1));
  const from = shown.mark < 0 ? first - Math.sign(way) : shown.mark;
  showMark(Math.min(last, Math.max(first, from + way)));
}

/** The limit that binds, as a bar along the foot of the chart, in that limit's colour. */
function bars(chart, plan) {
  const { ctx, bbox } = chart;
  ctx.save();
  ctx.beginPath(), ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height), ctx.clip();
  for (let i = 1, from = 0; i < plan.t_s.length; ++i) {
    if (i + 1 < plan.t_s.length && plan.binds[i + 1] === plan.binds[i]) continue;
    const [a, b] = [from, i].map((n) => chart.valToPos(plan.t_s[n], "x", true));
    ctx.fillStyle = colourOf(plan.binds[i]);
    ctx.fillRect(a, bbox.top + bbox.height - 5 * devicePixelRatio, Math.max(1, b - a), 5 * devicePixelRatio);
    from = i;
  }
  ctx.restore();
}

function tables() {
  const plan = program.plans[shown.plan],
    before = besides(plan);
  const key = make("p", { class: "small" }, "At the foot of the speed, what binds: ", ...limitsKey(plan));
  $("#over-time").firstElementChild.append(key);
  const lost = new Map((before?.lost ?? []).map((l) => [l.turn, l.time_s]));
  const columns = ["turn", "places", "lost / s", "by each / ms", ...(before ? [`plan ${before.plan} / s`] : [])];
  const rows = plan.lost.map((l) => [
    l.turn,
    String(l.count),
    l.time_s.toFixed(4),
    ((1e3 * l.time_s) / l.count).toFixed(3),
    ...(before ? [(lost.get(l.turn) ?? 0).toFixed(4)] : []),
  ]);
  const wide = (content) => make("div", { class: "wide" }, content);
  $("#lost").replaceChildren(make("h2", {}, "time lost against the programmed feed"), wide(table(columns, rows)));
  // The table has the class of motions; what else is to be said stands below it.
  const notes = [];
  const bounds = plan.bounds.map(({ name, time_s, motions, complete }) => {
    const [holds, ...more] = motions.split("; ");
    if (more.length) notes.push(make("p", { class: "small" }, `${name}: ${more.join("; ")}.`));
    const what = complete ? holds : `${holds} (unfinished: with more time it may be larger)`;
    return [name, time_s.toFixed(4), ((100 * time_s) / plan.cycle_time_s).toFixed(2), what];
  });
  const head = ["bound", "time / s", "of this plan / %", "holds for"];
  $("#bounds").replaceChildren(
    ...(bounds.length ? [make("h2", {}, "no motion is faster than"), wide(table(head, bounds)), ...notes] : []),
  );
}

function summary() {
  const plan = program.plans[shown.plan],
    before = besides(plan);
  const time = make("b", { id: "time", "data-value": plan.cycle_time_s }, seconds(plan.cycle_time_s));
  $("#sentence").replaceChildren(`Plan ${plan.plan}: `, time, ". Every sample holds its limits.");
  const saved = before ? before.cycle_time_s - plan.cycle_time_s : 0;
  const same = Math.abs(saved) < 1e-6; // of rounding
  const than = same ? "As long as" : `${instant(Math.abs(saved))} s ${saved < 0 ? "more" : "less"} than`;
  const beside = before ? [`${than} plan ${before.plan}, which is drawn in grey.`] : [];
  $("#today").textContent = [...beside, ...program.others].join(" ");
  $("#plans").replaceChildren(
    ...program.plans.map((p, i) => {
      const onclick = () => state.set({ plan: i ? p.plan : "" });
      const button = { type: "button", "aria-pressed": String(i === shown.plan), onclick };
      return make("button", button, `${p.plan}, ${seconds(p.cycle_time_s)}`);
    }),
  );
}

/** Draws what is other than before; at first, all. */
function show(now, before) {
  const found = program.plans.findIndex((p) => p.plan === now.plan);
  Object.assign(shown, { plan: Math.max(0, found), limits: now.by === "limit" });
  for (const one of document.querySelectorAll("#colour-by button"))
    one.setAttribute("aria-pressed", String((one.value === "limit") === shown.limits));
  const other = now.plan !== before?.plan;
  const at = now.at; // a chart that is made has no cursor
  if (other) {
    const focus = $("#plans").contains(document.activeElement);
    summary();
    if (focus) $("#plans [aria-pressed=true]").focus();
    shown.mark = scene.mark = -1;
  }
  if (other || now.by !== before?.by) drawPath();
  if (other) drawTime(), tables();
  else if (now.time !== before.time) zoomTo(charts, now.time);
  if (scene.view !== now.view) scene.view = now.view;
  if (now.corner !== (before?.corner ?? "")) {
    const corner = now.corner && program.corners[Number(now.corner)];
    openCorner(corner ? cornerTitle(corner) : "", corner ? addressOf(corner) : null);
  }
  showUndo(state.history);
  requestAnimationFrame(() => pointAt(at));
}

/** The cursor at a time, a text; empty: nowhere. */
function pointAt(at) {
  const t = Number(at);
  showMark(at !== "" && Number.isFinite(t) ? nearestTo(program.plans[shown.plan].t_s, t) : -1);
}

for (const button of document.querySelectorAll("#colour-by button"))
  button.addEventListener("click", () => state.set({ by: button.value === "limit" ? "limit" : "" }));
$("#undo").addEventListener("click", () => state.undo());
$("#redo").addEventListener("click", () => state.redo());
undoByKeys(state);
$("#corner button").addEventListener("click", () => (state.set({ corner: "" }), $("#path canvas").focus()));
/** This page as one file, with that of the open corner in it. */
async function pageText(wait) {
  const corner = await cornerText(wait);
  return frozen((copy) => {
    copy.querySelectorAll("#corner-list a").forEach((a) => a.removeAttribute("href"));
    copy.querySelectorAll("iframe").forEach((frame) => (frame.removeAttribute("src"), (frame.srcdoc = corner ?? "")));
  });
}
const saving = new Saving();
const file = `${baseName(program.name.replace(/^.*[/]|[.][^.]*$/g, ""))}.html`;
const say = (text) => ($("#info").textContent = text || "\u00a0");
$("#save").addEventListener("click", () => saving.save(pageText, file, say));
/** Charts of another size. */
function sized(fit) {
  const { at } = state.now; // charts that are resized move their cursors
  fit(charts);
  requestAnimationFrame(() => pointAt(at));
}
addEventListener("resize", () => {
  clearTimeout(drawTime.later);
  drawTime.later = setTimeout(() => sized(fit), 200);
});
addEventListener("beforeprint", () => sized(fitPaper));
addEventListener("afterprint", () => sized(fit));
show(state.now);
cornerList(program, { addressOf, feedsOf, open: choose });
document.title = `accdec explore: ${program.name}`;
globalThis.accdecProgram = { program, scene, charts, shown, state, addressOf, shades, pageText };
document.body.classList.add("ready");
