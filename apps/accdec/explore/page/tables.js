// The tables: what to set, all corners, taps, what binds.
import { make, ms, table, unit } from "./format.js";

/** ms that are set at a control: all their digits. */
const exact = (x) => ms(x / 1e3);
const percent = (x) => `${x >= 0 ? "+" : "\u2212"}${Math.abs(100 * x).toFixed(1)} %`;

/** "averages 67 ms, 31 ms; pair of impulses 12 ms apart" */
export function settings(family) {
  const s = family.settings;
  const parts = [];
  if (s.averages_ms.length)
    parts.push(
      `${s.averages_ms.length > 1 ? "averages" : "average"} ${s.averages_ms.map((x) => `${exact(x)} ms`).join(", ")}`,
    );
  else {
    const number = s.cutoff_Hz ? `cut-off ${+s.cutoff_Hz.toPrecision(6)} Hz` : family.parameters;
    parts.push(`${number ? `${number}, ` : ""}length ${exact(s.length_ms)} ms`);
  }
  if (s.pair_delay_ms !== undefined) parts.push(`impulses ${exact(s.pair_delay_ms)} ms apart`);
  return parts.join("; ");
}

/** The filter in use today, as the families are set: in ms. */
export function todayText({ result, parameters, settings: set }) {
  const text = settings({ parameters, settings: set });
  return set.averages_ms.length ? text : `${result.task.filter.kind}: ${text}`;
}

/** A name on one line: a long explanation in brackets is left to the tooltip. */
export const brief = (title) => title.replace(/ \(.{13,}\)$/, "");

function delays(samples, period, stops) {
  if (stops) return "exact stop";
  const shown = samples
    .slice(0, 4)
    .map((d) => ms(d * period))
    .join(", ");
  return `${shown}${samples.length > 4 ? ", .." : ""} ms`;
}

/**
 * @param all     the families of an answer of "families"
 * @param own     row of what is set today: {objective_s, delays_samples, text, exact_stop, of}, or null
 * @param design  row of the design, or null
 * @param task    the task as text; rows `of` another one are grey, and numbers of two tasks are not compared
 * @param chosen  name of the row that is compared with
 * @param choose  called with "today" or a family
 * @param open    whether the reasons are unfolded
 */
export function familyTable(all, own, design, task, period, chosen, choose, open) {
  const found = all.filter((f) => f.objective_s !== undefined).sort((a, b) => a.objective_s - b.objective_s);
  const rest = all.filter((f) => f.objective_s === undefined);
  const baseOf = (of) => (design?.of === of ? design.objective_s : undefined);
  // Slower by half fills the bar; a gap before its end says that it would be longer.
  const bar = (objective, base) =>
    make(
      "svg",
      { class: "bar", viewBox: "0 0 60 8", "aria-hidden": "true" },
      make("rect", { width: base ? Math.min(60, Math.max(0, 120 * (objective / base - 1))) : 0, height: 8 }),
      base && objective > 1.5 * base ? make("rect", { class: "cut", x: 50, width: 3, height: 8 }) : null,
    );
  const more = (objective, base) => (base ? percent(objective / base - 1) : "\u2013");
  const row = (name, title, text, d, objective, of, click) => ({
    attributes: {
      class: [chosen === name && "chosen", of !== task && "old"].filter(Boolean).join(" ") || undefined,
      "data-name": name,
    },
    cells: [
      click
        ? make(
            "button",
            { type: "button", class: "link", title, "aria-pressed": String(chosen === name), onclick: click },
            brief(title),
          )
        : make("b", {}, title),
      ms(objective),
      more(objective, baseOf(of)),
      bar(objective, baseOf(of)),
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
        `${design.order + 1} taps, ${ms((design.order + 1) * period)} ms`,
        delays(design.delays_samples, period, design.exact_stop),
        design.objective_s,
        design.of,
      ),
    );
  if (own)
    rows.push(
      row("today", "today", own.text, delays(own.delays_samples, period, own.exact_stop), own.objective_s, own.of, () =>
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
        f.of,
        () => choose(f),
      ),
    );
  const parts = [table(["filter", "time / ms", "more", "", "set", "delay"], rows)];
  if (rest.length) {
    const reasons = new Map();
    for (const f of rest) reasons.set(f.message, [...(reasons.get(f.message) ?? []), f.title]);
    const lines = [...reasons].map(([why, titles]) => make("p", { class: "small" }, `${titles.join("; ")}: ${why}`));
    const named = (words, some) => (some.length ? `${words}: ${some.map((f) => f.title).join("; ")}. ` : "");
    const unended = (f) => f.status === "failed";
    const none = named("Without a filter", rest.filter((f) => !unended(f)));
    const summary = make("summary", {}, none + named("Not searched to the end", rest.filter(unended)));
    parts.push(make("details", { class: "small", id: "reasons", open }, summary, ...lines));
  }
  return parts;
}

/** Which corner is drawn, where there are several. */
export function cornerButtons(place, result, chosen, choose) {
  const names = result.corners.map((c) => c.name);
  place.hidden = names.length < 2;
  const shown = JSON.stringify(names);
  if (place.dataset.shown !== shown) {
    place.dataset.shown = shown;
    const focused = place.contains(document.activeElement);
    const button = (name, i) => make("button", { type: "button", onclick: () => choose(i) }, name);
    place.replaceChildren(...names.map(button));
    if (focused) place.children[chosen].focus();
  }
  [...place.children].forEach((button, i) => button.setAttribute("aria-pressed", String(i === chosen)));
}

/** In the numbers of the command line. */
export const cornerTable = ({ head, rows }) => table(head.map(unit), rows);

/** Of very many taps the first ones. */
export function tapTable({ filter: { taps } }, most = 5000) {
  const rows = taps.slice(0, most).map((b, i) => [String(i), String(b)]);
  const more = taps.length - rows.length;
  const rest = more ? make("p", { class: "small" }, `and ${more} more: export the taps`) : null;
  return make("div", {}, table(["tap", "weight"], rows), rest);
}

/** A key, which a phone may show on several lines. */
const keyCell = (key) => make("span", {}, ...key.split(/(?<=[._])/).flatMap((part) => [part, make("wbr")]));

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
            keyCell(g.key),
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
    const { verdict, above, changes } = answer.words;
    const cell = (text) => unit(text).replace(/^-/, "\u2212");
    parts.push(make("p", {}, verdict));
    if (above) parts.push(make("p", {}, above), table(changes.head, changes.rows.map((row) => row.map(cell))));
  }
  parts.push(...answer.words.notes.map((note) => make("p", { class: "small" }, note)));
  return parts;
}
