// A number with its slider: linear over short ranges, else logarithmic around the value it had.
import { make } from "./format.js";

const steps = 240;

/** A number of three digits. */
const round = (x) => Number(x.toPrecision(3));

function scaleOf(key, value) {
  const low = key.low ?? -Infinity,
    high = key.high ?? Infinity;
  const whole = key.type === "integer";
  const least = key.open_low ? undefined : low;
  if (high - low <= 1000 && high - low > 2) {
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
  const from = Math.max(value / 10, low > 0 ? low : 0),
    to = Math.min(value * 10, high);
  const at = (p) => {
    const x = round(from * (to / from) ** (p / steps));
    return whole ? Math.round(x) : x;
  };
  return { from, to, count: steps, at, of: (x) => (steps * Math.log(Math.max(x, from) / from)) / Math.log(to / from) };
}

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
  const show = (source) => {
    const value = now();
    if (source !== number) number.value = value;
    if (source !== range) {
      if (value < scale.from || value > scale.to) scale = scaleOf(key, value);
      range.max = scale.count;
      range.value = Math.round(scale.of(value, scale));
    }
    range.setAttribute("aria-valuetext", String(value));
  };
  range.addEventListener("input", () => {
    put(scale.at(Number(range.value), scale));
    show(range);
  });
  range.addEventListener("keydown", (event) => {
    const way = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
    if (!way || !event.shiftKey) return;
    event.preventDefault();
    range.value = Number(range.value) + 10 * way;
    range.dispatchEvent(new Event("input"));
  });
  number.addEventListener("input", () => {
    const value = Number(number.value);
    const held = number.value !== "" && Number.isFinite(value) && (key.type !== "integer" || Number.isInteger(value));
    number.classList.toggle("wrong", !held);
    if (!held) return;
    put(value);
    show(number);
  });
  show();
  return {
    element: make("span", { class: "number" }, range, number),
    update: () => show(document.activeElement === number ? number : undefined),
  };
}
