// A chart of curves: design over before. It is made once and then gets new data; keys move its cursor.
import { four, make } from "./format.js";
import { colour, marks } from "./marks.js";

const sync = "time";

/** Values of several curves on one time axis; null where a curve has no point. @param period  of samples, or null */
function aligned(curves, period) {
  const snapped = (t) => (period ? Math.round(t / period) * period : t);
  const columns = uPlot.join(curves.map(({ time, values }) => [time.map(snapped), values]));
  return columns.map((column) => column.map((v) => v ?? null));
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
export function tickWidth(_, values) {
  const longest = Math.max(0, ...(values ?? []).map((v) => String(v ?? "").length));
  return Math.max(50, 16 + 7 * longest);
}
/** Steps between the numbers of an axis: 1, 2 or 5 of every power of ten. */
const steps = Array.from({ length: 26 }, (_, i) => i - 12).flatMap((p) => [1, 2, 5].map((n) => Number(`${n}e${p}`)));
/** The look of an axis. */
export const axisLook = () => ({
  incrs: steps,
  stroke: colour("ink"),
  grid: { stroke: colour("grid"), width: 1 },
  ticks: { show: false },
  font: "12px system-ui",
});
/** Values from zero to those of a chart, with the limits that are near and room for a word above the largest. */
export function rangeWith(low, high, limits) {
  const peak = Math.max(high, -low);
  // A limit far away would flatten the curve; the title names it.
  for (const { value } of limits)
    if (Math.abs(value) <= 1.6 * peak) (low = Math.min(low, value)), (high = Math.max(high, value));
  if (high === low) return [0, 1];
  const room = 0.17 * (high - low);
  return [low < 0 ? low - room : low, high > 0 ? high + room : high];
}
/** "; limit \u00b1300 of x, 20, off scale": those of {value, name} that are not in a range, for a title. */
export function offScale(limits, [low, high]) {
  const far = limits.filter(({ value }) => value < low || value > high);
  const words = far.flatMap(({ value, name }) => {
    const both = far.some((other) => other.value === -value);
    if (both && value < 0) return [];
    return [`${both ? "\u00b1" : ""}${four(value)}${name ? ` of ${name}` : ""}`];
  });
  return words.length ? `; limit ${words.join(", ")}, off scale` : "";
}
/** A number of a legend. */
export const shownValue = (self, v) => (v === null || v === undefined ? "\u2013" : four(v));
/** Room at the right for the last number of the axis below. */
export const padding = [null, 20, null, null];

/** A chart that is made once and then gets new data. */
export class Chart {
  constructor(place, { title, height = 190, log = false, together = true, between = false, xTitle = "time / ms" }) {
    Object.assign(this, { place, height, log, together, between, xTitle });
    if (title !== undefined) place.append(make("h2", {}, title), make("div", { class: "draw" }));
    this.heading = place.querySelector("h2");
    this.draw = place.querySelector(".draw");
    withKeys(this.draw, () => this.plot);
    this.observer = new ResizeObserver(() => this.resize());
    this.observer.observe(this.draw);
  }

  resize() {
    const width = Math.floor(this.draw.clientWidth);
    if (this.plot && width > 0 && width !== this.plot.width) this.plot.setSize({ width, height: this.height });
  }

  /**
   * specs: {label, values, time, dash, before, bound, steps, word, bars}; limits: {value, name}; x: range or null;
   * title: another one than before, to which limits are added that are not in the picture.
   */
  show(specs, limits, { period, x, y, extra, title }) {
    const signature = JSON.stringify(specs.map((s) => [s.label, s.dash, s.before, s.steps, s.bars]));
    const data = aligned(specs, this.between ? null : period);
    this.now = { specs, limits, x, y, extra };
    if (this.plot && signature === this.signature) {
      this.plot.setData(data, false);
      this.plot.setScale("x", this.range(data));
    } else {
      this.plot?.destroy();
      this.signature = signature;
      this.plot = new uPlot(this.options(specs), data, this.draw);
    }
    if (title) this.heading.textContent = title + offScale(limits, this.yRange({ data }));
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
    return rangeWith(low, high, limits);
  }

  options(specs) {
    const ink = axisLook();
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
          ...(this.log ? {} : { space: 24 }), // px between numbers: limits of both signs have one near
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
          spanGaps: true, // long motions have other points each
          points: { show: false },
          stroke: colour(spec.before ? "before" : "design"),
          width: spec.before ? 1.5 : (spec.thick ?? 2),
          dash: spec.dash ?? [],
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
