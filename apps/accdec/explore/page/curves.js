// Quantities over time: design over before, limits where they are and red where they bind. One cursor through all.
import { four, make, unit } from "./format.js";

export const binding = 0.999; // share of a limit from which it binds
const dashes = [[], [7, 4], [2, 3], [10, 3, 2, 3]];
const sync = "time";

export const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Values of several curves on one time axis; null where a curve has no sample. */
function aligned(curves, period) {
  const index = (t) => Math.round(t / period);
  let first = Infinity,
    last = -Infinity;
  for (const { time } of curves) (first = Math.min(first, index(time[0]))), (last = Math.max(last, index(time.at(-1))));
  const columns = [Array.from({ length: last - first + 1 }, (_, i) => (first + i) * period)];
  for (const { time, values } of curves) {
    const column = new Array(columns[0].length).fill(null);
    const from = index(time[0]) - first;
    values.forEach((v, i) => (column[from + i] = v));
    columns.push(column);
  }
  return columns;
}

/** The samples of a view between the start that ends and the stop that begins: the legs are as short as they can be. */
export function blendOnly(view) {
  const cut = (values) => values.slice(view.events.blend - 1, view.events.stop + 1);
  const axes = (q) => q.axes.map((axis) => ({ ...axis, values: cut(axis.values) }));
  return {
    ...view,
    time_ms: cut(view.time_ms),
    speed_mm_s: cut(view.speed_mm_s),
    path: { ...view.path, off_um: cut(view.path.off_um) },
    quantities: view.quantities.map((q) => ({ ...q, axes: axes(q) })),
  };
}

/** um from the legs; what is below a picometre is the rounding of numbers, and no distance. */
export const distances = (path) => path.off_um.map((x) => (x < 1e-6 ? 0 : x));

/** Power has a bound of its own for driving, above zero, and for braking, below. */
const sidesOf = { power: [1], regeneration: [-1] };

/** Words at the largest value of a curve, red bars where a limit binds, the zero line. */
export function marks(specs, limits) {
  return (plot) => {
    const { ctx } = plot;
    ctx.save();
    const ratio = devicePixelRatio;
    const { left, top, width, height } = plot.bbox;
    ctx.beginPath();
    ctx.rect(left, top, width, height);
    ctx.clip();
    for (const { value } of limits) {
      const y = plot.valToPos(value, "y", true);
      (ctx.strokeStyle = colour("limit")), (ctx.lineWidth = ratio), ctx.setLineDash([3 * ratio, 4 * ratio]);
      ctx.beginPath(), ctx.moveTo(left, y), ctx.lineTo(left + width, y), ctx.stroke();
    }
    ctx.setLineDash([]);
    (ctx.strokeStyle = colour("binds")), (ctx.lineWidth = 4 * ratio);
    specs.forEach((spec, i) => {
      if (!spec.bound || spec.before) return;
      const binds = spec.least
        ? (v) => Math.abs(v / spec.bound - 1) <= 1 - binding
        : (v) => Math.abs(v) >= binding * spec.bound && (spec.sides ?? [1, -1]).includes(Math.sign(v));
      plot.data[i + 1].forEach((v, n) => {
        if (v === null || n === 0 || !binds(v)) return;
        const y = plot.valToPos(Math.sign(v) * spec.bound, "y", true);
        const [a, b] = [n - 1, n].map((k) => plot.valToPos(plot.data[0][k], "x", true));
        ctx.beginPath(), ctx.moveTo(a, y), ctx.lineTo(b, y), ctx.stroke();
      });
    });
    (ctx.font = `${12 * ratio}px system-ui, sans-serif`), (ctx.textAlign = "center");
    specs.forEach((spec, i) => {
      if (!spec.word || spec.before) return;
      let best = -1;
      const { min, max } = plot.scales.x;
      plot.data[i + 1].forEach((v, n) => {
        const t = plot.data[0][n];
        if (v !== null && t >= min && t <= max && (best < 0 || Math.abs(v) > Math.abs(plot.data[i + 1][best]) * 1.0001))
          best = n;
      });
      if (best < 0) return;
      const v = plot.data[i + 1][best];
      const y = plot.valToPos(v, "y", true) + (v >= 0 ? -5 : 14) * ratio;
      ctx.fillStyle = colour("design");
      const x = Math.min(
        Math.max(plot.valToPos(plot.data[0][best], "x", true), left + 16 * ratio),
        left + width - 16 * ratio,
      );
      ctx.fillText(spec.word, x, Math.min(Math.max(y, top + 12 * ratio), top + height - 3 * ratio));
    });
    ctx.restore();
  };
}

/** Arrow keys move the cursor of a chart, and so that of all with it; Home and End go to its ends. */
export function withKeys(place, plotNow) {
  place.tabIndex = 0;
  place.addEventListener("keydown", (event) => {
    const plot = plotNow(),
      step = { ArrowLeft: -1, ArrowRight: 1, Home: -Infinity, End: Infinity }[event.key];
    if (!plot || !step) return;
    event.preventDefault();
    const shown = plot.data[0].map((t, i) => i).filter((i) => plot.valToPos(plot.data[0][i], "x") >= 0);
    const [first, last] = [shown[0], plot.data[0].findLastIndex((t) => t <= plot.scales.x.max)];
    const to = (plot.cursor.idx ?? first) + step * (event.shiftKey ? 10 : 1);
    const i = Math.min(last, Math.max(first, to));
    plot.setCursor({ left: plot.valToPos(plot.data[0][i], "x"), top: plot.over.clientHeight / 2 }, true, true);
  });
}

/** Numbers of an axis, and the width that they need: 7 px a character. */
export const ticks = (self, values) => values.map((v) => (v === null ? "" : four(v)));
export const tickWidth = (_, values) => Math.max(50, 16 + 7 * Math.max(0, ...(values ?? []).map((v) => String(v ?? "").length)));
/** A number of a legend. */
export const shownValue = (self, v) => (v === null || v === undefined ? "\u2013" : four(v));
/** Room at the right for the last number of the axis below. */
export const padding = [null, 20, null, null];

/** A chart that is made once and then gets new data. */
export class Chart {
  constructor(place, { title, height = 190, log = false, together = true, xTitle = "time / ms" }) {
    Object.assign(this, { place, height, log, together, xTitle });
    if (title !== undefined) {
      this.heading = make("h2", {}, title);
      this.draw = make("div", { class: "draw" });
      place.append(this.heading, this.draw);
    } else this.draw = place.querySelector(".draw");
    withKeys(this.draw, () => this.plot);
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.draw);
  }

  resize() {
    const width = Math.floor(this.draw.clientWidth);
    if (this.plot && width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: this.height });
  }

  /** specs: {label, values, time, axis, before, bound, steps, word, bars}; limits: {value}; x: range or null. */
  show(specs, limits, { period, x, y, extra }) {
    const signature = JSON.stringify(specs.map((s) => [s.label, s.axis, s.before, s.steps, s.bars]));
    const data = aligned(specs, period);
    this.now = { specs, limits, x, y, extra };
    if (this.plot && signature === this.signature) {
      this.plot.setData(data, false);
      this.plot.setScale("x", this.range(data));
      return;
    }
    this.plot?.destroy();
    this.signature = signature;
    this.plot = new uPlot(this.options(specs), data, this.draw);
  }

  range(data = this.plot.data) {
    const [min, max] = this.now.x ?? [data[0][0], data[0].at(-1)];
    return { min, max: max > min ? max : min + 1 };
  }

  yRange(plot) {
    const { limits, specs, y } = this.now;
    if (y) return y;
    let low = 0,
      high = 0;
    specs.forEach((spec, i) => {
      for (const v of plot.data[i + 1]) if (v !== null) (low = Math.min(low, v)), (high = Math.max(high, v));
    });
    const peak = Math.max(high, -low);
    // A limit far away would flatten the curve; it is named in the table.
    for (const { value } of limits)
      if (Math.abs(value) <= 1.6 * peak) (low = Math.min(low, value)), (high = Math.max(high, value));
    if (high === low) return [0, 1];
    const room = 0.12 * (high - low);
    return [low < 0 ? low - room : low, high > 0 ? high + room : high];
  }

  options(specs) {
    const ink = {
      stroke: colour("ink"),
      grid: { stroke: colour("grid"), width: 1 },
      ticks: { show: false },
      font: "12px system-ui",
    };
    return {
      padding,
      width: Math.max(200, Math.floor(this.draw.clientWidth)),
      height: this.height,
      scales: {
        x: {
          time: false,
          range: () => {
            const r = this.range();
            return [r.min, r.max];
          },
        },
        y: { range: (plot) => this.yRange(plot), distr: this.log ? 3 : 1 },
      },
      axes: [
        { ...ink, size: 26, values: ticks },
        {
          ...ink,
          size: tickWidth,
          values: this.log
            ? (s, v) => v.map((x) => (x !== null && Number.isInteger(Math.log10(x)) ? `${four(100 * x)} %` : ""))
            : ticks,
        },
      ],
      cursor: { ...(this.together ? { sync: { key: sync } } : {}), drag: { x: false, y: false }, points: { size: 6 } },
      legend: { live: true, markers: { show: false } },
      series: [
        { label: this.xTitle, value: shownValue },
        ...specs.map((spec) => ({
          label: spec.label,
          value: shownValue,
          scale: "y",
          spanGaps: false,
          points: { show: false },
          stroke: colour(spec.before ? "before" : "design"),
          width: spec.before ? 1.5 : (spec.thick ?? 2),
          dash: dashes[spec.axis % dashes.length],
          fill: spec.bars && !spec.before ? `${colour("design")}55` : undefined,
          paths: spec.steps
            ? uPlot.paths.stepped({ align: -1 })
            : spec.bars
              ? uPlot.paths.bars({ size: [0.7] })
              : undefined,
        })),
      ],
      hooks: {
        drawAxes: [(plot) => this.now.extra?.(plot)],
        draw: [(plot) => marks(this.now.specs, this.now.limits)(plot)],
      },
    };
  }
}

/** The charts of all quantities of a corner; made again only where other quantities are shown. */
export class Motion {
  constructor(place) {
    this.place = place;
    this.charts = new Map();
  }

  /** @param least  the smallest speed along the path that is allowed, or null */
  show(now, before, period, x, least) {
    const kinds = now.quantities.map((q) => q.kind);
    for (const [kind, chart] of this.charts) {
      if (!kinds.includes(kind)) chart.place.remove(), this.charts.delete(kind);
    }
    for (const quantity of now.quantities) {
      if (!this.charts.has(quantity.kind)) {
        const section = make("section", { "data-kind": quantity.kind });
        this.place.append(section);
        this.charts.set(quantity.kind, new Chart(section, { title: `${quantity.kind} / ${unit(quantity.unit)}` }));
      }
      const specs = [],
        limits = new Set();
      const old = before?.quantities.find((q) => q.kind === quantity.kind);
      old?.axes.forEach((axis, i) =>
        specs.push({
          label: `${axis.name} before`,
          time: before.time_ms,
          values: axis.values,
          axis: i,
          before: true,
          steps: quantity.kind !== "velocity",
        }),
      );
      const sides = sidesOf[quantity.kind] ?? [1, -1];
      quantity.axes.forEach((axis, i) => {
        specs.push({
          label: axis.name,
          word: axis.name,
          time: now.time_ms,
          values: axis.values,
          axis: i,
          bound: axis.bound,
          sides,
          steps: quantity.kind !== "velocity",
        });
        if (axis.bound !== null) for (const side of sides) limits.add(side * axis.bound);
      });
      if (quantity.kind === "velocity") {
        // The smallest speed is asked for between the legs: not at the start, nor at the stop.
        specs.push({ label: "path", time: now.time_ms, values: now.speed_mm_s, axis: 0, thick: 1, bound: least, least });
        if (least) limits.add(least);
      }
      this.charts.get(quantity.kind).show(
        specs,
        [...limits].map((value) => ({ value })),
        { period, x },
      );
    }
  }
}
