// Charts over time of a program: speed, then velocity, acceleration and jerk of every axis beside each other, places.
import { axisLook, offScale, padding, rangeWith, shownValue, tickWidth, ticks } from "./curves.js";
import { four, instant, lengthUnit, make } from "./format.js";
import { colour, marks } from "./marks.js";
import { titleOf } from "./motion.js";

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

/** The sample that the legend of a series shows: where plans have points at other times, each shows one that it has. */
function lookAt(plan, before, sample) {
  return (chart, series, nearest, t) => {
    const i = sample(t);
    const times = before && series === 1 ? before.t_s : plan.t_s;
    const time = times === plan.t_s ? times[i] : times[nearestTo(times, plan.t_s[i])];
    return nearestTo(chart.data[0], time);
  };
}

/** A number of the plan in grey. Where that has no point at the time of the cursor, its own time stands beside it. */
export function valueBeside(chart, v, _, i) {
  if (v === null || v === undefined || i === null) return shownValue(chart, v);
  const [t, at] = [chart.data[0][i], chart.data[0][chart.cursor.idxs[0]]];
  return Math.abs(t - at) < 1e-9 ? shownValue(chart, v) : `${shownValue(chart, v)} at ${instant(t)} s`;
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
  const shows = ({ scales: { x } }) => x.min === min && x.max === max;
  for (const other of charts) if (other !== chart && !shows(other)) other.setScale("x", { min, max });
}

/** The range of speeds is for cutting: rapid moves that are far faster leave it, and the title says so. */
function rangeOf(speeds) {
  const sorted = [...speeds].sort((a, b) => a - b);
  const most = sorted.at(-1),
    cutting = sorted[Math.floor(0.98 * (sorted.length - 1))] || 1;
  return most > 1.5 * cutting ? { range: [0, 1.5 * cutting], most } : { range: [0, 1.05 * most] };
}

/** Peak and root mean square of a force over the program. */
function overProgram({ peak, rms, rating }) {
  if (rms === undefined) return "";
  return `, peak ${four(peak)}, root mean square ${four(rms)}${rating === null ? "" : ` of ${four(rating)} allowed`}`;
}

/** Charts of force and power, a row for every axis, then that of all axes together. @returns as rowsOf */
function loadRows({ loads }) {
  const charts = loads.map((load, i) => [titleOf(load) + overProgram(load), (p) => p.loads[i].values, load.bounds]);
  const rows = new Map();
  loads.forEach(({ axis }, i) => rows.set(axis, [...(rows.get(axis) ?? []), charts[i]]));
  return [...rows.values()];
}

/** @returns [title, values of a plan, bounds above and below zero, or null][]: a row of charts */
function rowsOf(program, loads, speeds) {
  const of = (i) => `of ${program.axes[i]} / ${lengthUnit(program.axes[i])}`;
  const both = (bound) => [bound, bound === null ? null : -bound];
  const beyond = speeds.most ? `, rapid moves up to ${four(speeds.most)} beyond the picture` : "";
  return [
    [[`speed / mm/s${beyond}`, (p) => p.speed_mm_s, null]],
    ...program.axes.map((_, a) => [
      [`velocity ${of(a)}/s`, (p) => p.velocities_mm_s[a], both(program.velocity_max[a])],
      [`acceleration ${of(a)}/s\u00b2`, (p) => p.accelerations_mm_s2[a], both(program.acceleration_max[a])],
      [`jerk ${of(a)}/s\u00b3`, (p) => p.jerks_mm_s3[a], both(program.jerk_max[a])],
    ]),
    ...loads,
    program.axes.map((axis, a) => [`${axis} / ${lengthUnit(axis)}`, (p) => p.places_mm[a], null]),
  ];
}

const size = (draw) => ({ width: Math.max(260, draw.clientWidth), height: 170 });

/** Makes charts as wide as their places now are. */
export function fit(charts) {
  for (const { root } of charts) root.hidden = true; // a place is not held open by what is in it
  const sizes = charts.map(({ root }) => size(root.parentElement));
  charts.forEach((chart, i) => ((chart.root.hidden = false), chart.setSize(sizes[i])));
}

/** Makes charts about as large as they are on paper, so that their numbers are. There `fit` knows no places. */
export function fitPaper(charts) {
  for (const chart of charts) {
    const section = chart.root.closest("section");
    const half = section.matches(".three > :not(.loads > :nth-child(3))");
    chart.setSize({ width: half ? 336 : 685, height: 170 });
  }
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
  const loads = loadRows(plan);
  for (const row of rowsOf(program, loads, speeds)) {
    const classes = [row.length > 1 && "three", loads.includes(row) && "loads"].filter(Boolean).join(" ");
    const line = make("div", { class: classes });
    place.append(line);
    const drawn = row.map((one) => {
      const draw = make("div", { class: "draw", "aria-label": one[0] }),
        heading = make("h2", {}, one[0]);
      line.append(make("section", {}, heading, draw));
      return [draw, heading, ...one];
    });
    for (const [draw, heading, title, values, bounds] of drawn) {
      const series = [{ label: "s", value: (_, t) => (t === null ? "\u2013" : instant(t)) }];
      const line = { value: shownValue, width: 1.5, spanGaps: true };
      const specs = [{ bounds: bounds ?? [] }];
      let data = [plan.t_s, values(plan)];
      series.push({ ...line, label: plan.plan, stroke: colour("design") });
      if (before) {
        data = uPlot.join([
          [before.t_s, values(before)],
          [plan.t_s, values(plan)],
        ]);
        series.splice(1, 0, { ...line, label: before.plan, stroke: colour("before"), value: valueBeside });
        specs.unshift({ before: true });
      }
      const first = !charts.length; // the speed
      const limits = (bounds ?? []).filter((value) => value !== null).map((value) => ({ value }));
      const near = (_, low, high) => rangeWith(Math.min(0, low), Math.max(0, high), limits);
      const range = first ? speeds.range : bounds ? near : null;
      const ended = (u, key) => {
        if (key === "x") zoomed(charts, u), ranged(rangeText(u.scales.x, u.data[0]));
        else if (bounds) heading.textContent = title + offScale(limits, [u.scales.y.min, u.scales.y.max]);
      };
      const hooks = [(u) => marks(specs, limits)(u)];
      if (first) hooks.push((u) => bars(u, plan));
      const chart = new uPlot(
        {
          ...size(draw),
          scales: { x: { time: false, ...(time ? rangeFrom(time, data[0]) : {}) }, ...(range ? { y: { range } } : {}) },
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
            setScale: [ended],
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
