// A path in three dimensions on a canvas: turned, moved, zoomed; coloured piece by piece.

const degree = Math.PI / 180;
const digits = (x) => Number(x.toFixed(4));

export class Scene {
  /**
   * @param canvas  to draw on
   * @param told    called with the index of the point under the pointer, or -1
   * @param clicked called with the place of a click, px
   * @param viewed  called with the new view after it was turned, moved or zoomed
   */
  constructor(canvas, told, clicked, viewed) {
    Object.assign(this, { canvas, told, clicked, viewed, lines: [], dots: [], mark: -1 });
    new ResizeObserver(() => this.draw()).observe(canvas);
    this.listen();
  }

  /** lines: {places: [x, y, z] arrays, colour: i => text, width}; the first one answers the pointer. dots: places. */
  show(lines, dots) {
    const first = !this.lines.length;
    Object.assign(this, { lines, dots });
    if (first) this.home();
    this.draw();
  }

  home() {
    const wider = ([a, b], x) => [Math.min(a, x), Math.max(b, x)];
    const spans = this.lines[0].places.map((v) => v.reduce(wider, [Infinity, -Infinity]));
    this.centre = spans.map(([a, b]) => (a + b) / 2);
    this.size = Math.max(1e-6, Math.hypot(...spans.map(([a, b]) => b - a)));
    Object.assign(this, { yaw: -35 * degree, pitch: 30 * degree, zoom: 1, shift: [0, 0] });
    // A flat program is seen from above.
    const flat = spans.length < 3 || spans[2][1] - spans[2][0] < 0.02 * this.size;
    if (flat) Object.assign(this, { yaw: 0, pitch: 90 * degree });
    // The box of the program, as it is seen from here, fills the canvas.
    const corners = [...Array(8).keys()].map((i) => this.turned(spans.map((span, a) => span[(i >> a) & 1])));
    const extent = (way) => 2 * Math.max(1e-6 * this.size, ...corners.map((corner) => Math.abs(corner[way])));
    Object.assign(this, { wide: extent(0), tall: extent(1) });
    this.canvas.style.aspectRatio = String(Math.min(10, this.wide / this.tall));
    this.homeView = this.numbers().join();
  }

  /** Angles in degrees, zoom, shift in widths of the canvas. */
  numbers() {
    const shift = this.shift.map((v) => v / Math.max(1, this.canvas.clientWidth));
    return [this.yaw / degree, this.pitch / degree, this.zoom, ...shift].map(digits);
  }
  /** As text; empty: all of the path, as a page begins. */
  get view() {
    const text = this.numbers().join();
    return text === this.homeView ? "" : text;
  }
  set view(text) {
    this.home();
    const [yaw, pitch, zoom, x, y] = text.split(",").map(Number);
    if (![yaw, pitch, zoom, x, y].every((v) => Math.abs(v) < 1e6)) return this.draw(); // no numbers, or far away
    const shift = [x, y].map((v) => v * this.canvas.clientWidth);
    Object.assign(this, { yaw: yaw * degree, shift, zoom: 1 });
    this.pitch = 0;
    this.turn(0, pitch * degree);
    this.zoom = Math.min(1e4, Math.max(0.2, zoom));
  }

  /** A point from the centre, to the right and up: turned about z, then seen from `pitch` above the horizon. */
  turned(place) {
    const [x, y, z] = place.map((v, a) => v - this.centre[a]);
    const c = Math.cos(this.yaw),
      s = Math.sin(this.yaw);
    const across = c * x - s * (y ?? 0),
      away = s * x + c * (y ?? 0);
    return [across, away * Math.sin(this.pitch) + (z ?? 0) * Math.cos(this.pitch)];
  }
  /** px of a point. */
  at(place) {
    const [across, up] = this.turned(place);
    const { clientWidth, clientHeight } = this.canvas;
    const scale = 0.92 * this.zoom * Math.min(clientWidth / this.wide, clientHeight / this.tall);
    return [
      this.canvas.clientWidth / 2 + this.shift[0] + scale * across,
      this.canvas.clientHeight / 2 + this.shift[1] - scale * up,
    ];
  }
  point(line, i) {
    return this.at(line.places.map((v) => v[i]));
  }

  draw() {
    cancelAnimationFrame(this.frame);
    this.frame = requestAnimationFrame(() => this.drawNow());
  }
  drawNow() {
    if (!this.lines.length) return;
    const { canvas } = this,
      ratio = devicePixelRatio;
    const [w, h] = [canvas.clientWidth, canvas.clientHeight];
    if (canvas.width !== Math.round(w * ratio)) canvas.width = Math.round(w * ratio);
    if (canvas.height !== Math.round(h * ratio)) canvas.height = Math.round(h * ratio);
    const pen = canvas.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, w, h);
    pen.lineCap = "round";
    for (const line of [...this.lines].reverse()) {
      pen.lineWidth = line.width;
      let before = this.point(line, 0),
        colour = null;
      for (let i = 1; i < line.places[0].length; ++i) {
        const now = this.point(line, i),
          here = line.colour(i);
        if (here !== colour) {
          if (colour !== null) pen.stroke();
          pen.beginPath(), pen.moveTo(...before);
          pen.strokeStyle = colour = here;
        }
        pen.lineTo(...now);
        before = now;
      }
      if (colour !== null) pen.stroke();
    }
    pen.strokeStyle = "#222222";
    pen.lineWidth = 1;
    for (const dot of this.dots) pen.beginPath(), pen.arc(...this.at(dot), 3, 0, 7), pen.stroke();
    if (this.mark >= 0) {
      pen.fillStyle = "#000000";
      pen.beginPath(), pen.arc(...this.point(this.lines[0], this.mark), 5, 0, 7), pen.fill();
    }
  }

  /** The index of the nearest of these places within `reach`, or -1. */
  nearest(count, place, to, reach) {
    let best = reach * reach,
      found = -1;
    for (let i = 0; i < count; ++i) {
      const far = place(i).reduce((sum, x, a) => sum + (x - to[a]) ** 2, 0);
      if (far < best) (best = far), (found = i);
    }
    return found;
  }

  turn(yaw, pitch) {
    this.yaw += yaw;
    this.pitch = Math.min(90 * degree, Math.max(-90 * degree, this.pitch + pitch));
    this.draw();
  }
  enlarge(factor) {
    this.zoom = Math.min(1e4, Math.max(0.2, this.zoom * factor));
    this.shift = this.shift.map((v) => v * factor);
    this.draw();
  }

  listen() {
    const { canvas } = this;
    const at = (e) => [e.offsetX, e.offsetY];
    let held = null;
    canvas.addEventListener("pointerdown", (e) => {
      canvas.setPointerCapture(e.pointerId);
      held = { last: at(e), far: 0 };
    });
    canvas.addEventListener("pointermove", (e) => {
      if (!this.lines.length) return;
      const now = at(e);
      if (!held) {
        const line = this.lines[0];
        return this.told(this.nearest(line.places[0].length, (i) => this.point(line, i), now, 15));
      }
      const [dx, dy] = [now[0] - held.last[0], now[1] - held.last[1]];
      held = { last: now, far: held.far + Math.hypot(dx, dy) };
      if (e.shiftKey) (this.shift = [this.shift[0] + dx, this.shift[1] + dy]), this.draw();
      else this.turn(0.5 * degree * dx, 0.5 * degree * dy);
    });
    canvas.addEventListener("pointerup", (e) => {
      if (held && held.far < 4) this.clicked(at(e));
      else if (held) this.viewed(this.view);
      held = null;
    });
    canvas.addEventListener("pointercancel", () => (held = null));
    canvas.addEventListener(
      "wheel",
      (e) => {
        e.preventDefault();
        this.enlarge(Math.exp(-0.0015 * e.deltaY));
        this.viewed(this.view);
      },
      { passive: false },
    );
    const keys = {
      ArrowLeft: () => this.turn(-5 * degree, 0),
      ArrowRight: () => this.turn(5 * degree, 0),
      ArrowUp: () => this.turn(0, -5 * degree),
      ArrowDown: () => this.turn(0, 5 * degree),
      "+": () => this.enlarge(1.25),
      "-": () => this.enlarge(0.8),
      Home: () => (this.home(), this.draw()),
    };
    canvas.addEventListener("keydown", (e) => {
      if (!keys[e.key]) return;
      e.preventDefault();
      keys[e.key]();
      this.viewed(this.view);
    });
  }
}
