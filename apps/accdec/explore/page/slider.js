// A number with its slider: linear over short ranges, else over decades around the value it had.
import { make } from "./format.js";

const steps = 240;
const beside_slider = 7; // characters of a number that its field has room for beside the slider

/** A number of three digits. */
const round = (x) => Number(x.toPrecision(3));

/** Multiples of a number: places, and what they are. */
function multiplesOf(grain, key, value) {
  const count = { type: "integer", low: key.open_low ? 1 : 0, high: key.high / grain };
  const whole = scaleOf(count, Math.round(value / grain));
  const exact = (n) => Number((n * grain).toPrecision(12));
  return {
    grain,
    from: exact(whole.from),
    to: exact(whole.to),
    count: whole.count,
    at: (p) => exact(whole.at(p, whole)),
    of: (x) => whole.of(Math.round(x / grain), whole),
  };
}

function scaleOf(key, value) {
  if (key.grain?.()) return multiplesOf(key.grain(), key, value);
  const low = key.low ?? -Infinity,
    high = key.high ?? Infinity;
  const whole = key.type === "integer";
  const least = key.open_low ? undefined : low;
  if (high - low < 900 && high - low > 2) {
    const step = whole || high - low >= 100 ? 1 : (high - low) / steps;
    return {
      from: low + (key.open_low ? step : 0),
      to: high,
      count: Math.round((high - low) / step) - (key.open_low ? 1 : 0),
      at: (p, s) => s.from + p * step,
      of: (x, s) => (x - s.from) / step,
    };
  }
  if (low < 0) {
    const to = Math.min(high, Math.max(1, 2 * Math.abs(value)));
    return {
      from: -to,
      to,
      count: steps,
      at: (p) => round(((2 * p) / steps - 1) * to),
      of: (x) => ((x / to + 1) * steps) / 2,
    };
  }
  if (!(value > 0)) {
    const to = Math.min(high, 100);
    return {
      from: Math.max(0, least ?? 0),
      to,
      count: 100,
      at: (p) => round((to * p) / 100),
      of: (x) => (100 * x) / to,
    };
  }
  const part = (factor) => Number((value * factor).toPrecision(12)); // 0.34 of 3.4
  return overDecades(Math.max(part(0.1), low > 0 ? low : 0), Math.min(part(10), high), value, whole);
}

/** Round numbers, a half to two and a half per cent apart, and the value itself. */
function overDecades(from, to, value, whole) {
  const grid = new Set([from, value, to].map((x) => (whole ? Math.round(x) : x)));
  for (let power = Math.floor(Math.log10(from)); power <= Math.log10(to); ++power) {
    for (const [first, last, step] of [
      [100, 200, 2],
      [200, 500, 5],
      [500, 1000, 10],
    ])
      for (let digits = first; digits < last; digits += step) {
        const x = Number(`${digits}e${power - 2}`);
        if (x >= from && x <= to && (!whole || Number.isInteger(x))) grid.add(x);
      }
  }
  const places = [...grid].sort((a, b) => a - b);
  const of = (x) => places.findLastIndex((place) => place <= x);
  return { from, to, count: places.length - 1, at: (p) => places[p], of: (x) => Math.max(0, of(x)) };
}

/** The values that a number may have, in words. */
function allowed(key) {
  const kind = key.type === "integer" ? "a whole number" : "a number";
  const limits = [];
  const { from, to } = key.between?.() ?? {};
  if (from !== undefined) limits.push(`from ${from}`);
  else if (key.low > -1e300) limits.push(`${key.open_low ? "above" : "from"} ${key.low}`);
  if (to !== undefined) limits.push(`to ${to}`);
  else if (key.high < 1e300) limits.push(`to ${key.high}`);
  return [kind, ...limits].join(" ");
}

/** A comma that is typed is the point of a number. One that may divide thousands is not taken. */
function onComma(number, refuse) {
  number.addEventListener("beforeinput", (event) => {
    if (!event.data?.includes(",")) return;
    event.preventDefault();
    const text = event.data.trim();
    if (text === "," || /^[-+]?\d*,\d*$/.test(text) && !/,\d{3}$/.test(text))
      document.execCommand("insertText", false, text.replace(",", "."));
    else refuse(text);
  });
}

/** While a field holds no number, the answer on the page is not about what it shows. */
export const markUnread = () =>
  document.body.classList.toggle("unread", Boolean(document.querySelector("#controls .wrong")));

/** @returns the element, and what shows a new value in it */
export function slider(key, id, now, put) {
  let scale = scaleOf(key, now());
  const number = make("input", {
    type: "number",
    id,
    step: key.type === "integer" ? 1 : "any",
    min: key.low,
    max: key.high,
  });
  const range = make("input", {
    type: "range",
    "aria-label": `${key.name}, slider`,
    min: 0,
    max: scale.count,
    step: 1,
    id: `${id}-slider`,
  });
  const said = make("small", { class: "allowed", role: "alert", hidden: true });
  const wrong = (text) => {
    number.classList.toggle("wrong", Boolean(text));
    (said.textContent = text ?? ""), (said.hidden = !text);
    markUnread();
  };
  const element = make("span", { class: "number" }, range, number, said);
  const show = (source) => {
    const value = now();
    element.classList.toggle("long", String(value).length > beside_slider);
    if (source !== number) {
      number.value = value;
      if (number.classList.contains("wrong")) wrong(null);
    }
    if (source !== range) {
      if (value < scale.from || value > scale.to || scale.grain !== key.grain?.()) scale = scaleOf(key, value);
      range.max = scale.count;
      range.value = Math.round(scale.of(value, scale));
    }
    range.setAttribute("aria-valuetext", String(value));
  };
  /** The nearest value that keeps the ends of a band in their order. */
  const within = (value) => {
    const { from = -Infinity, to = Infinity } = key.between?.() ?? {};
    return Math.min(Math.max(value, from), to);
  };
  range.addEventListener("input", () => {
    const value = scale.at(Number(range.value), scale);
    put(within(value));
    show(within(value) === value ? range : undefined);
  });
  range.addEventListener("keydown", (event) => {
    const way = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (!way || !event.shiftKey) return;
    event.preventDefault();
    const before = range.value;
    range.value = Number(before) + 10 * way;
    if (range.value !== before) range.dispatchEvent(new Event("input"));
  });
  onComma(number, (text) => wrong(`${text} is not taken: a point divides; the last was ${now()}`));
  number.addEventListener("input", () => {
    const value = Number(number.value);
    const whole = key.type !== "integer" || Number.isInteger(value);
    const held = number.value !== "" && Number.isFinite(value) && whole && within(value) === value;
    wrong(held ? null : `${allowed(key)}; the last was ${now()}`);
    if (!held) return;
    put(value);
    show(number);
  });
  number.addEventListener("blur", () => {
    if (!number.classList.contains("wrong")) return;
    show();
    (said.textContent = `${now()} is back; allowed is ${allowed(key)}`), (said.hidden = false);
    setTimeout(() => number.classList.contains("wrong") || (said.hidden = true), 5000);
  });
  show();
  return {
    element,
    update: () => show(document.activeElement === number ? number : undefined),
  };
}
