// Marks over the curves of a chart: limits, red bars where they bind, the axes' names.

export const binding = 0.999; // share of a limit from which it binds

/** The one of a curve's bounds, above and below zero, that a value uses to the full; `least`: it is the smallest. */
export const boundAt = (v, { bounds, least }) =>
  bounds.find((bound) => bound && (least ? Math.abs(v / bound - 1) <= 1 - binding : v / bound >= binding));

const known = new Map();
/** A colour of the palette, read once: between two changes of the page, reading makes the browser work on both. */
export function colour(name) {
  if (!known.has(name))
    known.set(name, getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim());
  return known.get(name);
}

/** A word with a rim of paper, which sets it off from the lines below it. */
function words(ctx, text, at, name) {
  (ctx.strokeStyle = "#ffffff"), (ctx.lineWidth = 4 * devicePixelRatio), (ctx.lineJoin = "round");
  ctx.fillStyle = colour(name);
  ctx.strokeText(text, ...at), ctx.fillText(text, ...at);
}

/** Names of limits at the right ends of their lines; one whose line is near that below stands to the left of it. */
function limitNames({ ctx, bbox, valToPos }, limits) {
  const ratio = devicePixelRatio;
  (ctx.font = `${11 * ratio}px system-ui, sans-serif`), (ctx.textAlign = "right");
  let below = { y: Infinity };
  for (const { value, name } of [...limits].sort((a, b) => a.value - b.value)) {
    const y = valToPos(value, "y", true) - 4 * ratio;
    if (!name || y < bbox.top || y > bbox.top + bbox.height) continue;
    const right = below.y - y < 12 * ratio ? below.left : bbox.left + bbox.width;
    words(ctx, name, [right - 4 * ratio, y], "limit");
    below = { y, left: right - 8 * ratio - ctx.measureText(name).width };
  }
}

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
    ctx.beginPath();
    specs.forEach((spec, i) => {
      if (!spec.bounds || spec.before) return;
      plot.data[i + 1].forEach((v, n) => {
        const bound = v === null || n === 0 ? undefined : boundAt(v, spec);
        if (bound === undefined) return;
        const y = plot.valToPos(bound, "y", true);
        const [a, b] = [n - 1, n].map((k) => plot.valToPos(plot.data[0][k], "x", true));
        ctx.moveTo(a, y), ctx.lineTo(b, y);
      });
    });
    ctx.stroke();
    limitNames(plot, limits);
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
      const x = Math.min(
        Math.max(plot.valToPos(plot.data[0][best], "x", true), left + 16 * ratio),
        left + width - 16 * ratio,
      );
      const at = [x, Math.min(Math.max(y, top + 12 * ratio), top + height - 3 * ratio)];
      words(ctx, spec.word, at, "design");
    });
    ctx.restore();
  };
}
