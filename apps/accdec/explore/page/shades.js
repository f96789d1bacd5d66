// The colours of speeds: cutting has most of the scale, rapid moves the rest, and a bar says which is which.
import { four, make } from "./format.js";

const count = 64;

/** Speeds of 98 % of the samples are cutting. */
const usual = (speeds) => [...speeds].sort((a, b) => a - b)[Math.floor(0.98 * (speeds.length - 1))] || 1;

export class Shades {
  /** @param palette  "0 '#rrggbb', 0.35 '#rrggbb', ..", light to dark */
  constructor(palette) {
    const colours = [...palette.matchAll(/([\d.]+) '#(..)(..)(..)'/g)].map(([, at, ...hex]) => [
      Number(at),
      hex.map((h) => parseInt(h, 16)),
    ]);
    // Equal colours are drawn at once.
    this.shades = Array.from({ length: count + 1 }, (_, n) => {
      const q = n / count;
      const i = Math.max(
        1,
        colours.findIndex(([at]) => at >= q),
      );
      const [from, a] = colours[i - 1],
        [to, b] = colours[i];
      return `rgb(${a.map((c, k) => Math.round(c + ((q - from) / (to - from)) * (b[k] - c)))})`;
    });
  }

  /** The scale for these speeds. */
  fit(speeds) {
    this.most = Math.max(
      1e-9,
      speeds.reduce((a, b) => Math.max(a, b), 0),
    );
    const cutting = usual(speeds);
    // The knee: up to this speed the scale has `share` of its length.
    [this.knee, this.share] = this.most > 1.3 * cutting ? [cutting, 0.75] : [this.most, 1];
  }
  /** Place on the scale, from 0 to 1. */
  at(speed) {
    if (speed >= this.most) return 1;
    return speed <= this.knee
      ? (this.share * speed) / this.knee
      : this.share + ((1 - this.share) * (speed - this.knee)) / (this.most - this.knee);
  }
  of(speed) {
    return this.shades[Math.min(count, Math.round(count * this.at(speed)))];
  }

  /** Round speeds along the bar, none beside another one's number. */
  ticks() {
    const rounds = (from, to) => {
      const power = 10 ** Math.floor(Math.log10(to / 3)),
        step = [1, 2, 5, 10].find((s) => s * power * 4.5 >= to) * power;
      const all = [];
      for (let v = Math.ceil(from / step) * step; v <= to * 1.0001; v += step) all.push(Number(v.toPrecision(6)));
      return all;
    };
    const cutting = rounds(0, this.knee);
    const apart = (v) => this.at(v) - this.at(cutting.at(-1)) > 0.1;
    const rapid = this.share < 1 ? rounds(this.knee, this.most).filter(apart).slice(-1) : [];
    return [...cutting, ...rapid];
  }

  /** A bar with the speeds of its colours. */
  bar() {
    const [left, width] = [14, 340];
    const said = "colours of speeds in mm/s";
    const bar = make("svg", { class: "colourbar", viewBox: "0 0 400 34", role: "img", "aria-label": said });
    const each = width / (count + 1);
    this.shades.forEach((fill, n) =>
      bar.append(make("rect", { x: left + (n * width) / (count + 1), y: 2, width: each + 0.5, height: 12, fill })),
    );
    for (const v of this.ticks()) {
      const x = left + width * this.at(v);
      bar.append(make("line", { class: "tick", x1: x, x2: x, y1: 14, y2: 18 }));
      bar.append(make("text", { x, y: 31, "text-anchor": "middle" }, four(v)));
    }
    bar.append(make("text", { x: left + width + 8, y: 12 }, "mm/s"));
    return bar;
  }
}
