// Quantities over time at a corner: design over before, limits where they are and red where they bind.
import { Chart } from "./curves.js";
import { make, unit } from "./format.js";
import { boundAt } from "./marks.js";

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

/**
 * um from the legs at every sample, and between two where the path is farther off; what is below a picometre is the
 * rounding of numbers, and no distance.
 * @param period  ms
 */
export function distances({ time_ms, path }, period) {
  const samples = path.off_um.map((x, i) => [Math.round(time_ms[i] / period) * period, x]);
  const between = path.between.filter(([t]) => t > samples[0][0] && t < samples.at(-1)[0]);
  const points = [...samples, ...between].sort((a, b) => a[0] - b[0]);
  return { time: points.map(([t]) => t), values: points.map(([, x]) => (x < 1e-6 ? 0 : x)) };
}

/** "power of all axes / W"; with an axis "force of x / N" */
export function titleOf({ kind, unit: of, axis }) {
  const words = kind.replace("force_speed", "use of the force-speed curve").replace(/_total$/, " of all axes");
  return `${words.replaceAll("_", " ")}${axis ? ` of ${axis}` : ""} / ${unit(of)}`;
}

/** Axes that turn have charts of their own, in their units. */
const nameOf = ({ kind, unit: of }) => `${kind} ${of}`;

/** Limits with the names of their axes, if they differ. Where both signs have one, that above zero is named. */
const named = (limits, axes) =>
  [...limits].map(([value, names]) => ({
    value,
    name: names.length === axes || (value < 0 && limits.has(-value)) ? "" : names.join(", "),
  }));

/** The charts of all quantities of a corner; made again only where other quantities are shown. */
export class Motion {
  constructor(place) {
    this.place = place;
    this.charts = new Map();
  }

  /** @param least  the smallest speed along the path that is allowed, or null */
  show(now, before, period, x, least) {
    const names = now.quantities.map(nameOf);
    for (const [name, chart] of this.charts) {
      if (!names.includes(name)) chart.place.remove(), this.charts.delete(name);
    }
    const ordered = names.every((name) => this.charts.has(name));
    const [first] = now.quantities.filter((q) => q.kind === "velocity");
    for (const quantity of now.quantities) {
      const name = nameOf(quantity);
      if (!this.charts.has(name)) {
        const section = make("section", { "data-kind": quantity.kind });
        this.charts.set(name, new Chart(section, { title: titleOf(quantity) }));
      }
      const specs = [],
        limits = new Map(); // names of axes, by value
      const old = before?.quantities.find((q) => nameOf(q) === name);
      old?.axes.forEach((axis) =>
        specs.push({
          label: `${axis.name} before`,
          time: before.time_ms,
          values: axis.values,
          dash: axis.dash,
          before: true,
          steps: quantity.kind !== "velocity",
        }),
      );
      quantity.axes.forEach((axis) => {
        specs.push({
          label: axis.name,
          word: axis.name,
          time: now.time_ms,
          values: axis.values,
          dash: axis.dash,
          bounds: axis.bounds,
          steps: quantity.kind !== "velocity",
        });
        for (const bound of axis.bounds)
          if (bound !== null) limits.set(bound, [...(limits.get(bound) ?? []), axis.name]);
      });
      if (quantity === first) {
        // The smallest speed is asked for between the legs: not at the start, nor at the stop.
        const path = { label: "path", time: now.time_ms, values: now.speed_mm_s, thick: 1 };
        specs.push({ ...path, bounds: [least], least: true });
        if (least) limits.set(least, ["smallest allowed"]);
      }
      const chart = this.charts.get(name);
      if (!ordered) this.place.append(chart.place);
      const uses = (axis) => axis.values.some((v) => boundAt(v, axis) !== undefined);
      const bind = quantity.axes.filter(uses).map((axis) => axis.name);
      const binds = bind.length ? `: ${bind.join(", ")} ${bind.length > 1 ? "bind" : "binds"}` : "";
      chart.show(specs, named(limits, quantity.axes.length), { period, x, title: titleOf(quantity) + binds });
    }
  }
}
