// The page of a program: its path by speed, everything over time, where time is lost, one plan against the other.
import { $, four, instant, make, table } from "./format.js";
import { nearestTo, timeCharts } from "./over_time.js";
import { begin, stayAlive } from "./requests.js";
import { download, frozen } from "./save.js";
import { Scene } from "./scene.js";
import { Shades } from "./shades.js";
import { taskAddress } from "./state.js";

const start = await begin();
const { program } = start;
const shown = { plan: 0, mark: -1, limits: false };
const seconds = (s) => `${Number(s.toFixed(3))} s`;
const charts = [];
const shades = new Shades(program.palette);
const other = program.colours.at(-1);

const colourOf = (limit) => (limit < 0 ? other : program.colours[1 + limit]);

/** The names of the limits that bind somewhere, each with its colour. */
const limitsKey = (plan) =>
  [...new Set(plan.binds)].map((i) => {
    const swatch = make("svg", { class: "swatch", viewBox: "0 0 10 10", "aria-hidden": "true" });
    swatch.append(make("rect", { width: 10, height: 10, fill: colourOf(i) }));
    return make("span", {}, swatch, ` ${i < 0 ? program.other : program.limits[i]} `);
  });

/** Where a corner opens: the explorer with the corner as its task. */
const addressOf = (corner) => `index.html${taskAddress({ ...program.base, corner: [corner.corner] })}`;

const scene = new Scene($("#path canvas"), showMark, (place) => {
  const at = (i) => scene.at(program.corners[i].at_mm);
  const i = scene.nearest(program.corners.length, at, place, 15);
  if (i >= 0) open(addressOf(program.corners[i]), "_blank");
});

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
  const places = program.axes.map((name, a) => `${name} ${four(plan.places_mm[a][i])}`).join(", ");
  const limit = plan.binds[i] < 0 ? program.other : program.limits[plan.binds[i]];
  $("#info").textContent = `${instant(plan.t_s[i])} s: ${places} mm, ${four(plan.speed_mm_s[i])} mm/s; ${limit} binds`;
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
    before = program.plans.find((p) => p !== plan);
  charts.push(...timeCharts($("#over-time"), program, { plan, before, follow, sample, step, bars }));
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
  Object.assign(follow, { busy: false, from: null });
}
/** By keys: within what is shown of the time. */
function step(way, { min, max }) {
  const times = program.plans[shown.plan].t_s;
  const first = nearestTo(times, min),
    last = nearestTo(times, max);
  const from = shown.mark < 0 ? first - Math.sign(way) : shown.mark;
  showMark(Math.min(last, Math.max(first, from + way)));
}

/** What binds, as a bar along the foot of the chart, in the limit's colour. */
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
    before = program.plans.find((p) => p !== plan);
  $("#over-time").append(make("p", { class: "small" }, "At the foot of the speed, what binds: ", ...limitsKey(plan)));
  const lost = new Map((before?.lost ?? []).map((l) => [l.turn, l.time_s]));
  const head = ["turn", "joints", "lost / s", "by each / ms", ...(before ? [`plan ${before.plan} / s`] : [])];
  const rows = plan.lost.map((l) => [
    l.turn,
    String(l.count),
    four(l.time_s),
    four((1e3 * l.time_s) / l.count),
    ...(before ? [four(lost.get(l.turn) ?? 0)] : []),
  ]);
  const wide = (content) => make("div", { class: "wide" }, content);
  $("#lost").replaceChildren(make("h2", {}, "time lost against the programmed feed"), wide(table(head, rows)));
  const bounds = program.bounds.map((b) => [b.name, four(b.time_s), `${four((100 * b.time_s) / plan.cycle_time_s)} %`, b.motions]);
  if (bounds.length)
    $("#bounds").replaceChildren(
      make("h2", {}, "no motion is faster than"),
      wide(table(["bound", "time / s", "of this plan", "holds for"], bounds)),
    );
}

function cornerList() {
  const sharp = [...program.corners].sort((a, b) => a.angle_deg - b.angle_deg).slice(0, 20);
  const rows = sharp.map((c) => [
    make("a", { href: addressOf(c), target: "_blank" }, `line ${c.line}`),
    c.at_mm.map(four).join(", "),
    four(c.angle_deg),
    `${four(c.corner.feed_in_mm_min)}, ${four(c.corner.feed_out_mm_min)}`,
    c.corner.error_max_um === undefined ? "\u2013" : four(c.corner.error_max_um),
  ]);
  $("#corner-list").replaceChildren(
    make("h2", {}, `the sharpest of ${program.corners.length} corners: open one to design it by itself`),
    make("div", { class: "wide" }, table(["corner", `${program.axes.join(", ")} / mm`, "angle / \u00b0", "feeds / mm/min", "tolerance / \u00b5m"], rows)),
  );
}

function summary() {
  const plan = program.plans[shown.plan],
    before = program.plans.find((p) => p !== plan);
  const time = make("b", { id: "time", "data-value": plan.cycle_time_s }, seconds(plan.cycle_time_s));
  $("#sentence").replaceChildren(`Plan ${plan.plan}: `, time, ". Every sample holds its limits.");
  const saved = before ? before.cycle_time_s - plan.cycle_time_s : 0;
  $("#today").textContent = before
    ? `${seconds(Math.abs(saved))} ${saved < 0 ? "more" : "less"} than plan ${before.plan}, which is drawn in grey.`
    : "The other plan does not hold here.";
  $("#plans").replaceChildren(
    ...program.plans.map((p, i) =>
      make(
        "button",
        { type: "button", "aria-pressed": String(i === shown.plan), onclick: () => choose({ plan: i }) },
        `${p.plan}, ${seconds(p.cycle_time_s)}`,
      ),
    ),
  );
}

function draw() {
  summary();
  showMark(-1);
  drawPath();
  drawTime();
  tables();
}

/** What is shown stands in the address; back and forward of the browser undo and redo it. */
function choose(change) {
  const { plan, limits } = { ...shown, ...change };
  history.pushState(null, "", `#plan=${program.plans[plan].plan}&by=${limits ? "limit" : "speed"}`);
  fromAddress();
}
function fromAddress() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  const plan = Math.max(
    0,
    program.plans.findIndex((p) => p.plan === wanted.get("plan")),
  );
  Object.assign(shown, { plan, limits: wanted.get("by") === "limit" });
  for (const one of document.querySelectorAll("#colour-by button"))
    one.setAttribute("aria-pressed", String((one.value === "limit") === shown.limits));
  draw();
}
addEventListener("popstate", fromAddress);
for (const button of document.querySelectorAll("#colour-by button"))
  button.addEventListener("click", () => choose({ limits: button.value === "limit" }));
$("#undo").addEventListener("click", () => history.back());
$("#redo").addEventListener("click", () => history.forward());
const pageText = () => frozen((copy) => copy.querySelectorAll("#corner-list a").forEach((a) => a.removeAttribute("href")));
$("#save").addEventListener("click", async () => {
  download(new Blob([await pageText()], { type: "text/html" }), `${program.name.replace(/^.*[/]|[.][^.]*$/g, "")}.html`);
});
addEventListener("resize", () => {
  clearTimeout(draw.later);
  draw.later = setTimeout(() => (drawTime(), tables()), 200);
});
fromAddress();
cornerList();
document.title = `accdec explore: ${program.name}`;
globalThis.accdecProgram = { program, scene, shown, addressOf, shades, pageText };
stayAlive((gone) => document.body.classList.toggle("gone", gone));
document.body.classList.add("ready");
