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

/** Words at the largest value of a curve, red bars where a limit binds, the zero line. */
function marks(specs, limits) {
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
      plot.data[i + 1].forEach((v, n) => {
        if (v === null || n === 0 || !(Math.abs(v) >= binding * spec.bound)) return;
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

/** A chart that is made once and then gets new data. */
export class Chart {
  constructor(place, { title, height = 190, log = false, together = true, xTitle = "time / ms" }) {
    Object.assign(this, { place, height, log, together, xTitle });
    if (title !== undefined) {
      this.heading = make("h2", {}, title);
      this.draw = make("div", { class: "draw" });
      place.append(this.heading, this.draw);
    } else this.draw = place.querySelector(".draw");
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
    const room = 0.12 * (high - low || 1);
    return [low < 0 ? low - room : low, high > 0 ? high + room : high];
  }

  options(specs) {
    const ink = {
      stroke: colour("ink"),
      grid: { stroke: colour("grid"), width: 1 },
      ticks: { show: false },
      font: "12px system-ui",
    };
    const show = (self, values) => values.map((v) => (v === null ? "" : four(v)));
    const value = (self, v) => (v === null || v === undefined ? "\u2013" : four(v));
    return {
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
        { ...ink, size: 26, values: show },
        {
          ...ink,
          size: 66,
          values: this.log
            ? (s, v) => v.map((x) => (x !== null && Number.isInteger(Math.log10(x)) ? `${four(100 * x)} %` : ""))
            : show,
        },
      ],
      cursor: { ...(this.together ? { sync: { key: sync } } : {}), drag: { x: false, y: false }, points: { size: 6 } },
      legend: { live: true, markers: { show: false } },
      series: [
        { label: this.xTitle, value },
        ...specs.map((spec) => ({
          label: spec.label,
          value,
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

  show(now, before, period, x) {
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
      quantity.axes.forEach((axis, i) => {
        specs.push({
          label: axis.name,
          word: axis.name,
          time: now.time_ms,
          values: axis.values,
          axis: i,
          bound: axis.bound,
          steps: quantity.kind !== "velocity",
        });
        if (axis.bound !== null) limits.add(axis.bound).add(-axis.bound);
      });
      if (quantity.kind === "velocity")
        specs.push({ label: "path", time: now.time_ms, values: now.speed_mm_s, axis: 0, thick: 1 });
      this.charts.get(quantity.kind).show(
        specs,
        [...limits].map((value) => ({ value })),
        { period, x },
      );
    }
  }
}
