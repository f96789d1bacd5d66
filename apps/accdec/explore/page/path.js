// The path at the corner: design over before, the tolerance as a disc, the largest error as a line with its value.
import { four, make } from "./format.js";
import { binding } from "./marks.js";

const size = { width: 560, height: 380, left: 46, right: 12, top: 12, bottom: 34 };

/** Samples between which the path leaves the legs, and one on each side. */
function blendOf(path) {
  const most = Math.max(...path.off_um);
  let first = path.off_um.findIndex((x) => x > 0.01 * most),
    last = path.off_um.length - 1;
  while (last > 0 && path.off_um[last] <= 0.01 * most) --last;
  return most > 0 ? [Math.max(0, first - 1), Math.min(path.off_um.length - 1, last + 1)] : null;
}

/** The blend, as far as its distance from the legs can be seen, with the beginning of both legs. */
function extent(view, tolerance) {
  const box = [0, 0, 0, 0];
  const take = (x, y) => {
    (box[0] = Math.min(box[0], x)), (box[1] = Math.max(box[1], x));
    (box[2] = Math.min(box[2], y)), (box[3] = Math.max(box[3], y));
  };
  const most = Math.max(...view.path.off_um);
  const leaves = most > Math.max(0.02 * (tolerance ?? 0), 1e-6);
  const error = Math.min(...view.path.x_um.map((x, i) => Math.hypot(x, view.path.y_um[i])));
  // At a sharp corner, the path turns back far from it and near to both legs. One that turns back does not leave them.
  const reach = Math.max(leaves ? 4 * most : 1.5 * tolerance, 1.5 * error);
  const near = reach > 1e-6 ? reach : 100;
  const blend = leaves ? blendOf(view.path) : null;
  for (let i = blend?.[0] ?? 1; i <= (blend?.[1] ?? 0); ++i) {
    const x = view.path.x_um[i],
      y = view.path.y_um[i];
    if (Math.hypot(x, y) <= 1.6 * near) take(x, y);
  }
  for (const [x, y] of [view.path.in.map((u) => -u), view.path.out]) take(x * near, y * near);
  const size = Math.max(box[1] - box[0], box[3] - box[2]);
  const [across, up] = [box[1] - box[0], box[3] - box[2]].map((span) => 0.06 * Math.max(span, 1e-3 * size));
  return [box[0] - across, box[1] + across, box[2] - up, box[3] + up];
}

const nice = (span) => {
  const power = 10 ** Math.floor(Math.log10(span));
  return [1, 2, 5, 10].find((step) => step * power >= span) * power;
};

/** How many times y is drawn longer than x, where the path would fill less than half its panel; below 1: x than y. */
function stretchOf(aspect) {
  const most = [10, 8, 6, 5, 4, 3, 2].find((n) => n <= aspect || n <= 1 / aspect) ?? 1;
  return aspect > 1 ? most : 1 / most;
}

/** @param toUnit  factor from um, or from thousandths of a degree; units: of both directions */
function axes(box, at, names, toUnit, units, stretch) {
  const parts = [];
  const { left, right, top, bottom, width, height } = size;
  const step = nice((box[1] - box[0]) / 7);
  for (let x = Math.ceil(box[0] / step) * step; x <= box[1]; x += step) {
    const [px] = at(x, 0);
    parts.push(
      make("line", { class: "grid", x1: px, x2: px, y1: top, y2: height - bottom }),
      make(
        "text",
        { x: px, y: height - bottom + 14, "text-anchor": "middle" },
        four(Math.round(x / step) * step * toUnit),
      ),
    );
  }
  const rise = stretch === 1 ? step : nice((box[3] - box[2]) / 5);
  for (let y = Math.ceil(box[2] / rise) * rise; y <= box[3]; y += rise) {
    const [, py] = at(0, y);
    parts.push(
      make("line", { class: "grid", x1: left, x2: width - right, y1: py, y2: py }),
      make("text", { x: left - 5, y: py + 4, "text-anchor": "end" }, four(Math.round(y / rise) * rise * toUnit)),
    );
  }
  const longer = `, drawn ${four(Math.max(stretch, 1 / stretch))} times as long`;
  const [x, y] = names.map((name, i) => `${name} / ${units[i]}${(i ? stretch > 1 : stretch < 1) ? longer : ""}`);
  parts.push(
    make("text", { x: width - right, y: height - 3, "text-anchor": "end" }, x),
    make("text", { x: left, y: top - 2 }, y),
  );
  return parts;
}

function curve(view, at, name, dots) {
  const { x_um: x, y_um: y } = view.path;
  const points = x.map((v, i) => at(v, y[i]));
  // Points closer than a third of a pixel look like one.
  let last = [NaN, NaN];
  const apart = (p, i) => i === points.length - 1 || !(Math.hypot(p[0] - last[0], p[1] - last[1]) < 0.3);
  const line = make("polyline", {
    class: `line ${name}`,
    points: points
      .filter((p, i) => apart(p, i) && (last = p))
      .map((p) => p.map((v) => v.toFixed(2)).join(","))
      .join(" "),
  });
  const inside = points.filter(([px, py]) => px > 0 && px < size.width && py > 0 && py < size.height);
  const shown = dots && inside.length < 150 ? inside : [];
  return [
    line,
    ...shown.map(([px, py]) => make("circle", { class: `dot ${name}`, cx: px.toFixed(2), cy: py.toFixed(2), r: 2.3 })),
  ];
}

/** The place of words of 150 px in the corner of the drawing that is farthest from path and legs. */
function emptiest(points, legs) {
  const { left, right, top, bottom, width, height } = size;
  const onLegs = [0, 1].flatMap((leg) =>
    Array.from({ length: 600 }, (_, i) => legs[leg].map((v, a) => v + (i / 600) * (legs[leg + 1][a] - v))),
  );
  const all = [...points, ...onLegs].filter(([x, y]) => x > 0 && x < width && y > 0 && y < height);
  const places = [
    { x: width - right - 6, y: top + 16, anchor: "end" },
    { x: left + 6, y: top + 16, anchor: "start" },
    { x: width - right - 6, y: height - bottom - 8, anchor: "end" },
    { x: left + 6, y: height - bottom - 8, anchor: "start" },
  ];
  const room = ({ x, y, anchor }) => {
    const middle = anchor === "end" ? x - 75 : x + 75;
    return Math.min(200, ...all.map(([a, b]) => Math.hypot(Math.max(0, Math.abs(a - middle) - 75), b - y + 4)));
  };
  return places.map((place) => [room(place), place]).reduce((a, b) => (b[0] > a[0] ? b : a))[1];
}

/**
 * @param place   element to draw in
 * @param now     {view, corner, tolerance}: of the design; corner is its entry in the result, tolerance in um or null
 * @param before  {view} of what it is compared with, or null
 */
export function drawPath(place, now, before) {
  const boxes = [now, before].filter(Boolean).map((one) => extent(one.view, now.tolerance));
  const box = boxes.reduce((a, b) => [
    Math.min(a[0], b[0]),
    Math.max(a[1], b[1]),
    Math.min(a[2], b[2]),
    Math.max(a[3], b[3]),
  ]);
  const plot = [size.width - size.left - size.right, size.height - size.top - size.bottom];
  const spans = [box[1] - box[0], box[3] - box[2]];
  const fits = [plot[0] / spans[0], plot[1] / spans[1]];
  // A direction without motion is drawn as it is.
  const flat = Math.min(...spans) < 1e-3 * Math.max(...spans);
  const stretch = flat ? 1 : stretchOf(fits[1] / fits[0]);
  const scale = Math.min(fits[0], fits[1] / stretch),
    scales = [scale, scale * stretch];
  // The rest is shared.
  for (const [i, span] of [
    [0, plot[0] / scales[0]],
    [2, plot[1] / scales[1]],
  ]) {
    const more = (span - (box[i + 1] - box[i])) / 2;
    (box[i] -= more), (box[i + 1] += more);
  }
  const at = (x, y) => [size.left + (x - box[0]) * scales[0], size.top + (box[3] - y) * scales[1]];
  const large = box[1] - box[0] > 4000;
  const { view, corner, tolerance } = now;
  const units = view.path.units.map(([small, big]) => (large ? big : small));
  const [cx, cy] = at(0, 0);
  const parts = [make("title", {}, `path at corner ${view.name}`)];
  const clip = [];
  const binds = 1e6 * corner.corner_error_m >= binding * tolerance;
  const looks = binds ? "tolerance binds" : "tolerance";
  const [rx, ry] = scales.map((scale) => tolerance * scale);
  if (tolerance) clip.push(make("ellipse", { class: looks, cx, cy, rx, ry }));
  const far = 3 * Math.hypot(box[1] - box[0], box[3] - box[2]);
  const legs = [
    at(-view.path.in[0] * far, -view.path.in[1] * far),
    [cx, cy],
    at(view.path.out[0] * far, view.path.out[1] * far),
  ];
  clip.push(make("polyline", { class: "programmed", points: legs.map((p) => p.join(",")).join(" ") }));
  if (before) clip.push(...curve(before.view, at, "before", false));
  clip.push(...curve(view, at, "design", true));
  const distance = view.path.x_um.map((x, i) => Math.hypot(x, view.path.y_um[i]));
  const nearest = distance.indexOf(Math.min(...distance));
  const [ex, ey] = at(view.path.x_um[nearest], view.path.y_um[nearest]);
  clip.push(make("line", { class: "error", x1: cx, y1: cy, x2: ex, y2: ey }));
  const inner = make(
    "svg",
    {
      x: size.left,
      y: size.top,
      width: plot[0],
      height: plot[1],
      viewBox: `${size.left} ${size.top} ${plot[0]} ${plot[1]}`,
    },
    ...clip,
  );
  parts.push(...axes(box, at, view.path.names, large ? 1e-3 : 1, units, stretch), inner);
  const words = `error ${four(1e6 * corner.corner_error_m)} \u00b5m${tolerance ? ` of ${four(tolerance)}` : ""}`;
  const drawn = view.path.x_um.map((x, i) => at(x, view.path.y_um[i]));
  const { x, y, anchor } = emptiest(drawn, legs);
  parts.push(make("text", { class: "said", x, y, "text-anchor": anchor }, words));
  place.replaceChildren(
    make(
      "svg",
      {
        viewBox: `0 0 ${size.width} ${size.height}`,
        role: "img",
        "aria-label": `path at corner ${view.name}, ${words}`,
      },
      ...parts,
    ),
  );
}
