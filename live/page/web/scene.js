// The instrument in space: as a whole, and around the tip. Dragging turns both, the wheel zooms one.
import { fit, colours } from "./canvas.js";

const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const times = (s, a) => [s * a[0], s * a[1], s * a[2]];

/// The direction that both views share: R's z is up.
export class Orbit {
  constructor() { Object.assign(this, { azimuth: -0.9, elevation: 0.32 }); }

  axes() {
    const [ca, sa, ce, se] = [Math.cos(this.azimuth), Math.sin(this.azimuth), Math.cos(this.elevation), Math.sin(this.elevation)];
    return { right: [-sa, ca, 0], up: [-ca * se, -sa * se, ce] };
  }

  follow(view, redraw) {
    const { canvas } = view;
    let last = null;
    canvas.addEventListener("pointerdown", (event) => {
      last = [event.clientX, event.clientY];
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!last) return;
      this.azimuth -= 0.008 * (event.clientX - last[0]);
      this.elevation = Math.min(1.55, Math.max(-1.55, this.elevation + 0.008 * (event.clientY - last[1])));
      last = [event.clientX, event.clientY];
      redraw();
    });
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, () => { last = null; });
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      view.zoom = Math.min(20, Math.max(0.2, view.zoom * Math.exp(-0.0015 * event.deltaY)));
      redraw();
    }, { passive: false });
    canvas.addEventListener("dblclick", () => { view.zoom = 1; redraw(); });
  }
}

export class View {
  /// `near`: the way and the path fill the view, not the shaft.
  constructor(canvas, orbit, near) {
    Object.assign(this, { canvas, orbit, near, zoom: 1, centre: null, radius: 0 });
  }

  /// Centre and radius of what is shown; they follow slowly, so that the view does not tremble.
  frame(points) {
    let low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (const p of points) {
      low = low.map((v, i) => Math.min(v, p[i]));
      high = high.map((v, i) => Math.max(v, p[i]));
    }
    const centre = times(0.5, add(low, high));
    const radius = Math.max(this.near ? 0.004 : 0.02, 0.5 * Math.sqrt(dot(sub(high, low), sub(high, low))));
    if (!this.centre || Math.sqrt(dot(sub(centre, this.centre), sub(centre, this.centre))) > this.radius) {
      [this.centre, this.radius] = [centre, radius];
    } else {
      this.centre = add(this.centre, times(0.1, sub(centre, this.centre)));
      this.radius += 0.1 * (radius - this.radius);
    }
  }

  /// `s`: { shaft, wrist, port, tip, goal, path, way, workspace }, places in R or null.
  draw(s) {
    const around = this.near
      ? [s.tip || s.end, s.goal, ...s.path, ...s.way]
      : [s.wrist, s.port, ...s.shaft];
    const shown = around.filter(Boolean);
    const { ctx, width, height } = fit(this.canvas);
    if (!shown.length) return;
    this.frame(shown);
    const { right, up } = this.orbit.axes();
    const scale = this.zoom * 0.42 * Math.min(width, height) / this.radius;
    const px = (p) => {
      const d = sub(p, this.centre);
      return [width / 2 + scale * dot(d, right), height / 2 - scale * dot(d, up)];
    };
    const ink = colours();
    ctx.lineCap = ctx.lineJoin = "round";
    if (s.workspace) this.box(ctx, s.workspace, px, ink.line);
    this.line(ctx, s.path, px, ink.path, 1.5, [5, 4]);
    this.line(ctx, s.way, px, ink.way, 2);
    this.line(ctx, s.shaft, px, ink.shaft, this.near ? 4 : 3);
    if (s.port) this.portMark(ctx, px(s.port), ink);
    if (!this.near && s.wrist) this.square(ctx, px(s.wrist), 6, ink.wrist);
    if (s.goal) this.ring(ctx, px(s.goal), this.near ? 8 : 5, ink.goal, 2.5);
    const tip = s.tip || s.end;
    if (tip) this.disc(ctx, px(tip), this.near ? 4.5 : 4, ink.tip);
    if (!this.near) this.names(ctx, s, px, ink);
    this.triad(ctx, right, up, height, ink);
    this.ruler(ctx, scale, width, height, ink);
  }

  line(ctx, points, px, colour, width, dash = []) {
    if (points.length < 2) return;
    ctx.strokeStyle = colour;
    ctx.lineWidth = width;
    ctx.setLineDash(dash);
    ctx.beginPath();
    points.forEach((p, i) => (i ? ctx.lineTo(...px(p)) : ctx.moveTo(...px(p))));
    ctx.stroke();
    ctx.setLineDash([]);
  }

  box(ctx, box, px, colour) {
    const corner = (i) => [0, 1, 2].map((a) => (i >> a & 1 ? box.upper_m[a] : box.lower_m[a]));
    for (let i = 0; i < 8; ++i)
      for (let a = 0; a < 3; ++a)
        if (!(i >> a & 1)) this.line(ctx, [corner(i), corner(i | 1 << a)], px, colour, 1);
  }

  names(ctx, s, px, ink) {
    ctx.font = "12px system-ui, sans-serif";
    ctx.fillStyle = ink.quiet;
    ctx.textAlign = "left";
    const name = (p, text) => p && ctx.fillText(text, px(p)[0] + 10, px(p)[1] + 4);
    name(s.wrist, "wrist");
    name(s.port, "port");
    name(s.tip || s.end, "tip");
  }

  disc(ctx, [x, y], r, colour) {
    ctx.fillStyle = colour;
    ctx.beginPath();
    ctx.arc(x, y, r, 0, 2 * Math.PI);
    ctx.fill();
  }
  ring(ctx, [x, y], r, colour, width) {
    ctx.strokeStyle = colour;
    ctx.lineWidth = width;
    ctx.beginPath();
    ctx.arc(x, y, r, 0, 2 * Math.PI);
    ctx.stroke();
  }
  square(ctx, [x, y], r, colour) {
    ctx.fillStyle = colour;
    ctx.fillRect(x - r, y - r, 2 * r, 2 * r);
  }
  portMark(ctx, at, ink) {
    this.ring(ctx, at, 7, ink.port, 3);
  }

  /// R's axes, at the lower left.
  triad(ctx, right, up, height, ink) {
    const [x0, y0] = [26, height - 24];
    ctx.font = "11px system-ui, sans-serif";
    ctx.textAlign = "center";
    ["x", "y", "z"].forEach((name, i) => {
      const end = [x0 + 18 * right[i], y0 - 18 * up[i]];
      ctx.strokeStyle = ctx.fillStyle = ink.quiet;
      ctx.lineWidth = 1.5;
      ctx.beginPath();
      ctx.moveTo(x0, y0);
      ctx.lineTo(...end);
      ctx.stroke();
      ctx.fillText(name, x0 + 26 * right[i], y0 - 26 * up[i] + 4);
    });
  }

  ruler(ctx, scale, width, height, ink) {
    const most_m = 0.3 * width / scale;
    const power = 10 ** Math.floor(Math.log10(most_m));
    const length_m = power * [5, 2, 1].find((f) => f * power <= most_m);
    const [x, y] = [width - 10, height - 10];
    ctx.strokeStyle = ctx.fillStyle = ink.quiet;
    ctx.lineWidth = 1.5;
    ctx.beginPath();
    ctx.moveTo(x - scale * length_m, y - 4);
    ctx.lineTo(x - scale * length_m, y);
    ctx.lineTo(x, y);
    ctx.lineTo(x, y - 4);
    ctx.stroke();
    ctx.textAlign = "right";
    ctx.font = "12px system-ui, sans-serif";
    ctx.fillText(`${Number((1e3 * length_m).toPrecision(2))} mm`, x, y - 8);
  }
}
