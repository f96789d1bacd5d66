// Charts over time of a program: speed, then velocity, acceleration and jerk of every axis beside each other, places.
import { axisLook, padding, shownValue, tickWidth, ticks } from "./curves.js";
import { four, instant, make } from "./format.js";
import { colour, marks } from "./marks.js";

/** The index of the time that is nearest. */
export function nearestTo(times, t) {
  let low = 0,
    high = times.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] < t) low = middle;
    else high = middle;
  }
  return t - times[low] < times[high] - t ? low : high;
}

/** The sample that the legend of a series shows: two plans have other times, and each shows one that it has. */
function lookAt(plan, before, sample) {
  return (chart, series, nearest, t) => {
    const i = sample(t);
    const times = before && series === 1 ? before.t_s : plan.t_s;
    const time = times === plan.t_s ? times[i] : times[nearestTo(times, plan.t_s[i])];
    return nearestTo(chart.data[0], time);
  };
}

/** Shows more or less of the time, around the cursor or the middle. */
function enlarge(chart, factor) {
  const { min, max } = chart.scales.x,
    times = chart.data[0];
  const at = chart.cursor.left >= 0 ? chart.posToVal(chart.cursor.left, "x") : (min + max) / 2;
  const near = (t) => at + (t - at) / factor;
  if (near(max) - near(min) < 10 * (times[1] - times[0])) return;
  chart.setScale("x", { min: Math.max(times[0], near(min)), max: Math.min(times.at(-1), near(max)) });
}

/**
 * Arrow keys move the cursor from sample to sample; Home and End go to the ends of what is shown; + and - show less or
 * more of the time.
 */
function withKeys(draw, chart, step) {
  draw.tabIndex = 0;
  draw.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: -1, ArrowRight: 1, Home: -Infinity, End: Infinity }[event.key];
    const factor = { "+": 1.6, "-": 1 / 1.6 }[event.key];
    if (!way && !factor) return;
    event.preventDefault();
    if (way) step(way * (event.shiftKey ? 10 : 1), chart.scales.x);
    else enlarge(chart, factor);
  });
}

/** The part of the time that is shown, as text: "from,to" in s; empty for all of it. */
function rangeText({ min, max }, times) {
  const near = (a, b) => Math.abs(a - b) < 1e-6 * times.at(-1);
  return near(min, times[0]) && near(max, times.at(-1)) ? "" : [min, max].map((t) => Number(t.toPrecision(6))).join();
}
function rangeFrom(text, times) {
  const [first, last] = [times[0], times.at(-1)];
  const [from, to] = text.split(",").map(Number);
  const part = { min: Math.max(first, from), max: Math.min(last, to) };
  return part.max > part.min ? part : { min: first, max: last };
}
/** Shows this part of the time, a text as above. */
export function zoomTo(charts, text) {
  if (charts.length) charts[0].setScale("x", rangeFrom(text, charts[0].data[0]));
}

/** Shows the same part of the time in all charts. */
function zoomed(charts, chart) {
  const { min, max } = chart.scales.x;
  for (const other of charts)
    if (other !== chart && (other.scales.x.min !== min || other.scales.x.max !== max)) other.setScale("x", { min, max });
}

/** The range of speeds is for cutting: rapid moves that are far faster leave it, and the title says so. */
function rangeOf(speeds) {
  const sorted = [...speeds].sort((a, b) => a - b);
  const most = sorted.at(-1),
    cutting = sorted[Math.floor(0.98 * (sorted.length - 1))] || 1;
  return most > 1.5 * cutting ? { range: [0, 1.5 * cutting], most } : { range: [0, 1.05 * most] };
}

/** @returns [title, values of a plan, bound or null][]: a row of charts */
function rowsOf(program, speeds) {
  const name = (i) => program.axes[i];
  const beyond = speeds.most ? `, rapid moves up to ${four(speeds.most)} beyond the picture` : "";
  return [
    [[`speed / mm/s${beyond}`, (p) => p.speed_mm_s, null]],
    ...program.axes.map((_, a) => [
      [`velocity of ${name(a)} / mm/s`, (p) => p.velocities_mm_s[a], program.velocity_max[a]],
      [`acceleration of ${name(a)} / mm/s\u00b2`, (p) => p.accelerations_mm_s2[a], program.acceleration_max[a]],
      [`jerk of ${name(a)} / mm/s\u00b3`, (p) => p.jerks_mm_s3[a], program.jerk_max[a]],
    ]),
    program.axes.map((axis, a) => [`${axis} / mm`, (p) => p.places_mm[a], null]),
  ];
}

const size = (draw) => ({ width: Math.max(260, draw.clientWidth), height: 170 });

/** Makes charts as wide as their places now are. */
export function fit(charts) {
  for (const { root } of charts) root.hidden = true; // a place is not held open by what is in it
  const sizes = charts.map(({ root }) => size(root.parentElement));
  charts.forEach((chart, i) => ((chart.root.hidden = false), chart.setSize(sizes[i])));
}

/**
 * In place of what was there.
 * @param follow  called with the chart whose cursor moves
 * @param sample  the plan's sample at a time: one for all charts
 * @param step    moves the cursor by samples within a range of time
 * @param bars    draws what binds
 * @param time    the part of the time that is shown at first, as text
 * @param ranged  called with another part
 * @returns the charts
 */
export function timeCharts(place, program, { plan, before, follow, sample, step, bars, time, ranged }) {
  const speeds = rangeOf(plan.speed_mm_s);
  const charts = [];
  place.replaceChildren();
  for (const row of rowsOf(program, speeds)) {
    const line = make("div", { class: row.length > 1 ? "three" : undefined });
    place.append(line);
    const drawn = row.map((one) => {
      const draw = make("div", { class: "draw", "aria-label": one[0] });
      line.append(make("section", {}, make("h2", {}, one[0]), draw));
      return [draw, ...one];
    });
    for (const [draw, title, values, bound] of drawn) {
      const series = [{ label: "s", value: (_, t) => (t === null ? "\u2013" : instant(t)) }];
      const specs = [{ bounds: [bound, -bound] }];
      let data = [plan.t_s, values(plan)];
      series.push({ label: plan.plan, value: shownValue, stroke: colour("design"), width: 1.5, spanGaps: true });
      if (before) {
        data = uPlot.join([
          [before.t_s, values(before)],
          [plan.t_s, values(plan)],
        ]);
        series.splice(1, 0, { label: before.plan, value: shownValue, stroke: colour("before"), width: 1.5, spanGaps: true });
        specs.unshift({ before: true });
      }
      const first = !charts.length; // the speed
      const limits = bound === null ? [] : [bound, -bound].map((value) => ({ value }));
      const hooks = [(u) => marks(specs, limits)(u)];
      if (first) hooks.push((u) => bars(u, plan));
      const chart = new uPlot(
        {
          ...size(draw),
          scales: { x: { time: false, ...(time ? rangeFrom(time, data[0]) : {}) }, ...(first ? { y: { range: speeds.range } } : {}) },
          legend: { live: true },
          padding,
          cursor: { drag: { x: true, y: false }, dataIdx: lookAt(plan, before, sample) },
          axes: [
            { ...axisLook(), size: 26, values: ticks },
            { ...axisLook(), size: tickWidth, values: ticks },
          ],
          series,
          hooks: {
            setCursor: [(u) => follow(u)],
            setScale: [(u, key) => key === "x" && (zoomed(charts, u), ranged(rangeText(u.scales.x, u.data[0])))],
            draw: hooks,
          },
        },
        data,
        draw,
      );
      withKeys(draw, chart, step);
      charts.push(chart);
    }
  }
  return charts;
}
