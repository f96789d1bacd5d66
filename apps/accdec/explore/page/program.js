// The page of a program: its path by speed, everything over time, where time is lost, one plan against the other.
import { $, four, make, table } from "./format.js";
import { begin, stayAlive } from "./requests.js";
import { Scene } from "./scene.js";
import { taskAddress } from "./state.js";

const start = await begin();
const { program } = start;
const shown = { plan: 0, mark: -1, limits: false };
const seconds = (s) => `${Number(s.toFixed(3))} s`;
const charts = [];
const colours = [...program.palette.matchAll(/([\d.]+) '#(..)(..)(..)'/g)].map(([, at, ...hex]) => [
  Number(at),
  hex.map((h) => parseInt(h, 16)),
]);
const other = program.colours.at(-1);

/** Of a share 0 .. 1 of the largest speed, in 64 steps: equal colours are drawn at once. */
const shades = Array.from({ length: 65 }, (_, n) => {
  const q = n / 64,
    i = Math.max(
      1,
      colours.findIndex(([at]) => at >= q),
    );
  const [from, a] = colours[i - 1],
    [to, b] = colours[i];
  return `rgb(${a.map((c, k) => Math.round(c + ((q - from) / (to - from)) * (b[k] - c)))})`;
});

/** The largest speed of 98 % of the samples: rapid moves would leave one colour for all cutting. */
const usual = (speeds) => [...speeds].sort((a, b) => a - b)[Math.floor(0.98 * (speeds.length - 1))] || 1;

/** The scale of speeds is for cutting: rapid moves that are far faster leave it. */
function cutting(plan) {
  const most = plan.speed_mm_s.reduce((a, b) => Math.max(a, b), 0);
  return [0, Math.min(1.05 * most, 1.5 * usual(plan.speed_mm_s))];
}

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

const scene = new Scene($("#path canvas"), tell, (place) => {
  const at = (i) => scene.at(program.corners[i].at_mm);
  const i = scene.nearest(program.corners.length, at, place, 15);
  if (i >= 0) open(addressOf(program.corners[i]), "_blank");
});

function tell(i) {
  shown.mark = scene.mark = i;
  const plan = program.plans[shown.plan];
  scene.draw();
  if (i < 0) return ($("#info").textContent = "\u00a0");
  const places = program.axes.map((name, a) => `${name} ${four(plan.places_mm[a][i])}`).join(", ");
  const limit = plan.binds[i] < 0 ? program.other : program.limits[plan.binds[i]];
  $("#info").textContent = `${four(plan.t_s[i])} s: ${places} mm, ${four(plan.speed_mm_s[i])} mm/s; ${limit} binds`;
  for (const chart of charts) {
    const left = chart.valToPos(plan.t_s[i], "x");
    if (Math.abs(chart.cursor.left - left) > 0.5) chart.setCursor({ left, top: chart.cursor.top ?? 0 }, false);
  }
}

function drawPath() {
  const plan = program.plans[shown.plan];
  const most = usual(plan.speed_mm_s);
  const bySpeed = (i) => shades[Math.min(64, Math.round((64 * plan.speed_mm_s[i]) / most))];
  const colour = shown.limits ? (i) => colourOf(plan.binds[i]) : bySpeed;
  const lines = [{ places: plan.places_mm.slice(0, 3), colour, width: 2 }];
  scene.show(lines, program.corners.length <= 300 ? program.corners.map((c) => c.at_mm.slice(0, 3)) : []);
  $("#path h2").textContent = shown.limits
    ? "path in the colour of the limit that binds"
    : `path in the colour of its speed, dark from ${four(most)} mm/s`;
  $("#path-key").replaceChildren(...(shown.limits ? limitsKey(plan) : []));
}

/** One chart a quantity: that of the other plan in grey below. All have one cursor. */
function drawTime() {
  for (const chart of charts.splice(0)) chart.destroy();
  $("#over-time").replaceChildren();
  const plan = program.plans[shown.plan],
    before = program.plans.find((p) => p !== plan);
  const quantities = [
    ["speed / mm/s", (p) => p.speed_mm_s],
    ...program.axes.map((name, a) => [`velocity of ${name} / mm/s`, (p) => p.velocities_mm_s[a]]),
    ...program.axes.map((name, a) => [`${name} / mm`, (p) => p.places_mm[a]]),
  ];
  for (const [title, values] of quantities) {
    const place = make("div", { class: "draw" });
    $("#over-time").append(make("h2", {}, title), place);
    const series = [{ label: "s" }];
    let data = [plan.t_s, values(plan)];
    series.push({ label: plan.plan, stroke: program.colours[1], width: 1.5 });
    if (before) {
      data = uPlot.join([
        [before.t_s, values(before)],
        [plan.t_s, values(plan)],
      ]);
      series.splice(1, 0, { label: before.plan, stroke: other, width: 1.5, spanGaps: true });
      series[2].spanGaps = true;
    }
    const options = {
      width: Math.max(300, place.clientWidth),
      height: 170,
      scales: { x: { time: false }, ...(title.startsWith("speed") ? { y: { range: cutting(plan) } } : {}) },
      legend: { live: true },
      cursor: { sync: { key: "time" }, drag: { x: true, y: false } },
      axes: [{ size: 26 }, { size: 66 }],
      series,
      hooks: { setCursor: [(u) => follow(u)], draw: title.startsWith("speed") ? [(u) => bars(u, plan)] : [] },
    };
    charts.push(new uPlot(options, data, place));
  }
}

/** The cursor over time moves the mark on the path. */
function follow(chart) {
  if (!(chart.cursor.left >= 0) || follow.busy) return;
  const times = program.plans[shown.plan].t_s,
    t = chart.posToVal(chart.cursor.left, "x");
  let low = 0,
    high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] < t) low = middle;
    else high = middle;
  }
  if (high === shown.mark) return;
  follow.busy = true;
  tell(high);
  follow.busy = false;
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
        { type: "button", "aria-pressed": String(i === shown.plan), onclick: () => ((shown.plan = i), draw()) },
        `${p.plan}, ${seconds(p.cycle_time_s)}`,
      ),
    ),
  );
}

function draw() {
  summary();
  tell(-1);
  drawPath();
  drawTime();
  tables();
}

for (const button of document.querySelectorAll("#colour-by button"))
  button.addEventListener("click", () => {
    shown.limits = button.value === "limit";
    for (const one of document.querySelectorAll("#colour-by button"))
      one.setAttribute("aria-pressed", String(one === button));
    drawPath();
  });
addEventListener("resize", () => {
  clearTimeout(draw.later);
  draw.later = setTimeout(() => (drawTime(), tables()), 200);
});
draw();
cornerList();
document.title = `accdec explore: ${program.name}`;
globalThis.accdecProgram = { program, scene, shown, addressOf };
stayAlive((gone) => document.body.classList.toggle("gone", gone));
document.body.classList.add("ready");
