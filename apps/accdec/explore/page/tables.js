// The tables: what to set, all corners, taps, what binds.
import { four, make, ms, table } from "./format.js";

const percent = (x) => `${x >= 0 ? "+" : "\u2212"}${Math.abs(100 * x).toFixed(1)} %`;

/** "averages 67 ms, 31 ms; pair of impulses 12 ms apart" */
export function settings(family) {
  const s = family.settings;
  const parts = [];
  if (s.averages_ms.length)
    parts.push(
      `${s.averages_ms.length > 1 ? "averages" : "average"} ${s.averages_ms.map((x) => `${four(x)} ms`).join(", ")}`,
    );
  else parts.push(`${family.parameters ? `${family.parameters}, ` : ""}length ${four(s.length_ms)} ms`);
  if (s.pair_delay_ms !== undefined) parts.push(`impulses ${four(s.pair_delay_ms)} ms apart`);
  return parts.join("; ");
}

function delays(samples, period, exact) {
  if (exact) return "exact stop";
  const shown = samples
    .slice(0, 4)
    .map((d) => four(d * period * 1e3))
    .join(", ");
  return `${shown}${samples.length > 4 ? ", .." : ""} ms`;
}

/**
 * @param all     answer of "families"
 * @param own     row of what is set today: {objective_s, delays_samples, text, exact_stop}, or null
 * @param design  the design's result, or null
 * @param chosen  name of the row that is compared with
 * @param choose  called with "today" or a family
 * @param open    whether the reasons are unfolded
 */
export function familyTable(all, own, design, period, chosen, choose, open) {
  const found = all.families.filter((f) => f.objective_s !== undefined).sort((a, b) => a.objective_s - b.objective_s);
  const rest = all.families.filter((f) => f.objective_s === undefined);
  const base = design?.objective_s;
  // Slower by half or more fills the bar.
  const bar = (objective) =>
    make(
      "svg",
      { class: "bar", viewBox: "0 0 60 8", "aria-hidden": "true" },
      make("rect", { width: base ? Math.min(60, Math.max(0, 120 * (objective / base - 1))) : 0, height: 8 }),
    );
  const more = (objective) => (base ? percent(objective / base - 1) : "\u2013");
  const row = (name, title, text, d, objective, click, old) => ({
    attributes: {
      class: [chosen === name && "chosen", old && "old"].filter(Boolean).join(" ") || undefined,
      "data-name": name,
    },
    cells: [
      click
        ? make(
            "button",
            { type: "button", class: "link", "aria-pressed": String(chosen === name), onclick: click },
            title,
          )
        : make("b", {}, title),
      ms(objective),
      more(objective),
      bar(objective),
      text,
      d,
    ],
  });
  const rows = [];
  if (design)
    rows.push(
      row(
        "design",
        design.name,
        `${design.order + 1} taps, ${four((design.order + 1) * period * 1e3)} ms`,
        delays(design.delays_samples, period),
        design.objective_s,
      ),
    );
  if (own)
    rows.push(
      row("today", "today", own.text, delays(own.delays_samples, period, own.exact_stop), own.objective_s, () =>
        choose("today"),
      ),
    );
  for (const f of found)
    rows.push(
      row(
        f.name,
        f.title,
        settings(f),
        delays(f.delays_samples, period, f.exact_stop),
        f.objective_s,
        () => choose(f),
        f.old,
      ),
    );
  const parts = [table(["filter", "time / ms", "more", "", "set", "delay"], rows)];
  if (rest.length) {
    const reasons = new Map();
    for (const f of rest) reasons.set(f.message, [...(reasons.get(f.message) ?? []), f.title]);
    const lines = [...reasons].map(([why, titles]) => make("p", { class: "small" }, `${titles.join("; ")}: ${why}`));
    const names = rest.map((f) => f.title).join("; ");
    parts.push(make("details", { class: "small", open }, make("summary", {}, `Without a filter: ${names}`), ...lines));
  }
  return parts;
}

/** Which corner is drawn, where there are several. */
export function cornerButtons(place, result, chosen, choose) {
  const names = result.corners.map((c) => c.name);
  place.hidden = names.length < 2;
  const shown = JSON.stringify([names, chosen]);
  if (place.dataset.shown === shown) return;
  place.dataset.shown = shown;
  const button = (name, i) =>
    make("button", { type: "button", "aria-pressed": String(i === chosen), onclick: () => choose(i) }, name);
  place.replaceChildren(...names.map(button));
}

export function cornerTable(result) {
  const um = (x) => four(1e6 * x);
  return table(
    [
      "corner",
      "delay / samples",
      "delay / ms",
      "error / \u00b5m",
      "of",
      "polyline / \u00b5m",
      "contour / \u00b5m",
      "least speed / mm/s",
      "time / ms",
    ],
    result.corners.map((c, i) => [
      c.name,
      String(c.delay_samples),
      four(c.delay_samples * result.sample_period_s * 1e3),
      um(c.corner_error_m),
      result.task.corner[i].error_max_um === undefined ? "\u2013" : four(result.task.corner[i].error_max_um),
      um(c.polyline_error_m),
      um(c.contour_deviation_m),
      four(1e3 * c.speed_min_m_s),
      ms(c.corner_time_s),
    ]),
  );
}

export const tapTable = (result) =>
  table(
    ["tap", "weight"],
    result.filter.taps.map((b, i) => [String(i), String(b)]),
  );

/** Of `explain`. */
export function explanationTable(answer) {
  const parts = [];
  if (answer.gains) {
    const places = new Map(); // where, by limit
    for (const b of answer.bindings) {
      const limit = [b.kind.replaceAll("_", " "), b.axis].filter(Boolean).join(" ");
      const where = [b.event !== "none" && b.event, answer.task.corner.length > 1 && b.corner]
        .filter(Boolean)
        .join(" ");
      places.set(limit, [...(places.get(limit) ?? []), where].filter(Boolean));
    }
    const used = [...places].map(([limit, where]) => (where.length ? `${limit} (${where.join(", ")})` : limit));
    parts.push(make("p", {}, used.length ? `Used to the full: ${used.join("; ")}.` : "No limit is used to the full."));
    const nothing = answer.gains.filter((g) => g.gain_s === 0 && g.proved);
    parts.push(
      table(
        ["10 % more room for", "key", "saves / ms", "at most / ms", ""],
        answer.gains
          .filter((g) => !nothing.includes(g))
          .map((g) => [
            g.name,
            g.key,
            ms(g.gain_s),
            g.gain_at_most_s === null ? "\u2013" : ms(g.gain_at_most_s),
            g.proved ? "proved" : "",
          ]),
      ),
    );
    if (nothing.length)
      parts.push(
        make("p", { class: "small" }, `Proved to save nothing by itself: ${nothing.map((g) => g.name).join("; ")}.`),
      );
  } else {
    const enough = (r) => r.levers.map((l) => `${l.key} = ${four(l.enough)} instead of ${four(l.value)}`).join("; ");
    parts.push(make("p", {}, answer.message));
    parts.push(
      table(
        ["one of these is enough", "change"],
        (answer.remedies ?? []).filter((r) => r.helps === "yes").map((r) => [r.name, enough(r)]),
      ),
    );
  }
  if (!answer.complete) parts.push(make("p", { class: "small" }, "The time was up before all was known."));
  return parts;
}
