// Taps and frequency response.
import { Chart } from "./curves.js";
import { binding, colour } from "./marks.js";

const points = 300;
const most_drawn = 4000; // taps

/** |sum b_i exp(-(z + j sqrt(1 - z^2)) 2 pi f (N - i) T)| */
function left(taps, f, period, damping) {
  const natural = 2 * Math.PI * f * period,
    turn = natural * Math.sqrt(1 - damping * damping),
    fall = Math.exp(-damping * natural);
  const c = fall * Math.cos(turn),
    s = fall * Math.sin(turn);
  let re = 0,
    im = 0;
  for (const tap of taps) [re, im] = [re * c - im * s + tap, re * s + im * c];
  return Math.hypot(re, im);
}

/** The least damping of all modes: more of it leaves less. */
function leastDamping(modes) {
  return modes.length ? Math.min(...modes.map((m) => [m.damping_ratio ?? 0].flat()[0])) : 0;
}

function top(taps, period, modes) {
  const most = Math.max(8 / (taps.length * period), ...modes.map((m) => 1.5 * [m.frequency_Hz].flat().at(-1)));
  return Math.min(most, 0.5 / period);
}

/** Of very many taps the largest of each group that is narrower than a pixel. */
function shownTaps(taps, ms) {
  const group = Math.ceil(taps.length / most_drawn);
  const largest = (_, n) => Math.max(...taps.slice(n * group, (n + 1) * group));
  const values = Array.from({ length: Math.ceil(taps.length / group) }, largest);
  return { time: values.map((_, n) => n * group * ms), values };
}

export class FilterCharts {
  constructor(taps, response) {
    this.taps = new Chart(taps, { together: false, xTitle: "ms" });
    this.heading = response.querySelector("h2");
    this.response = new Chart(response, { together: false, log: true, xTitle: "Hz" });
  }

  /** @param before  the filter it is compared with, or undefined */
  show(result, before) {
    const { filter: now, sample_period_s: period } = result,
      modes = result.task.mode ?? [];
    const ms = 1e3 * period;
    const tap = (filter, rest) => ({ ...shownTaps(filter.taps, ms), ...rest });
    const specs = [tap(now, { label: "design", bars: true })];
    if (before) specs.push(tap(before, { label: "before", before: true, steps: true }));
    const last = Math.max(now.taps.length, before?.taps.length ?? 0);
    this.taps.show(specs, [], { period: ms, x: [-ms, last * ms] });

    const high = top(now.taps, period, modes),
      step = high / points;
    const grid = Array.from({ length: points + 1 }, (_, i) => i * step);
    const damping = leastDamping(modes);
    const curve = (filter, rest) => ({
      time: grid,
      values: grid.map((f) => Math.max(1e-6, left(filter.taps, f, period, damping))),
      ...rest,
    });
    const lines = before ? [curve(before, { label: "before", before: true })] : [];
    lines.push(curve(now, { label: "design" }));
    const least = Math.min(...lines.flatMap(({ values }) => values), ...modes.map((m) => m.residual_max ?? 1));
    const low = Math.min(0.1, Math.max(1e-4, 10 ** Math.floor(Math.log10(least))));
    this.heading.textContent = `Vibration left over frequency / Hz${largest(result.limits)}`;
    const extra = (plot) => bands(plot, modes, result.limits);
    this.response.show(lines, [], { period: step, x: [0, high], y: [low, 1.5], extra });
  }
}

/** ": x 98.2 % used" or ": x binds", of the mode whose vibration is nearest to its limit. */
function largest(uses) {
  const all = uses.filter((u) => u.kind === "vibration" || u.kind === "residual");
  if (!all.length) return "";
  const { axis, utilisation } = all.reduce((a, b) => (b.utilisation > a.utilisation ? b : a));
  return `: ${axis || "a mode"} ${utilisation >= binding ? "binds" : `${(100 * utilisation).toFixed(1)} % used`}`;
}

/** Whether the use of a limit is that of a mode. */
function isOf(mode, { kind, axis, bound, frequency_Hz: f }) {
  const list = [mode.frequency_Hz].flat();
  if (!(f >= list[0] && f <= list.at(-1))) return false;
  if (!mode.axis) return kind === "vibration" && bound === mode.residual_max;
  return kind === "residual" && axis === mode.axis && Math.abs(1e6 * bound / mode.residual_max_um - 1) < 1e-9;
}

/**
 * The bands of the modes, and the vibration that may be left in them: in red where it binds. The limit of an axis is an
 * amplitude, which has no place on a scale of parts: where it binds, the band has red edges.
 */
function bands(plot, modes, uses) {
  const { ctx, bbox } = plot;
  ctx.save();
  for (const mode of modes) {
    const list = [mode.frequency_Hz].flat();
    const [a, b] = [list[0], list.at(-1)].map((f) => plot.valToPos(f, "x", true));
    const wide = Math.max(b - a, 3 * devicePixelRatio),
      from = (a + b - wide) / 2;
    ctx.fillStyle = colour("tolerance");
    ctx.fillRect(from, bbox.top, wide, bbox.height);
    const binds = uses.some((u) => u.utilisation >= binding && isOf(mode, u));
    const thick = (binds ? 4 : 1) * devicePixelRatio;
    ctx.fillStyle = colour(binds ? "binds" : "limit");
    if (mode.axis) {
      if (binds) for (const x of [from, from + wide]) ctx.fillRect(x - thick / 2, bbox.top, thick, bbox.height);
      continue;
    }
    const y = plot.valToPos(Math.max(mode.residual_max, 1e-4), "y", true);
    ctx.fillRect(from, y - thick / 2, wide, thick);
  }
  ctx.restore();
}
