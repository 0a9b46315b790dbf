// Deviation and standard deviation of the tip over the last minute, one strip each.
import { fit, colours } from "./canvas.js";

const SPAN_S = 60, MOST = 2400;
const STRIPS = [
  { key: "deviation_m", name: "off the path, mm", colour: "tip" },
  { key: "sd_m", name: "tip's standard deviation, mm", colour: "shaft" },
];

/// The next of 1, 2, 5 times a power of ten.
function roundUp(v) {
  const power = 10 ** Math.floor(Math.log10(v));
  return power * [1, 2, 5, 10].find((f) => f * power >= v * (1 - 1e-9));
}

export class Plots {
  constructor(canvas) {
    this.canvas = canvas;
    this.rows = [];  // { t, deviation_m, sd_m }
  }

  reset(rows) { this.rows = rows; }

  add(row) {
    const last = this.rows.at(-1);
    if (last && row.t <= last.t) return;
    this.rows.push(row);
    while (this.rows.length > MOST || this.rows[0].t < row.t - SPAN_S) this.rows.shift();
  }

  draw() {
    const { ctx, width, height } = fit(this.canvas);
    const ink = colours();
    const gap = 24, bottom = 16, left = 40;
    const tall = (height - bottom - gap * STRIPS.length) / STRIPS.length;
    const end = this.rows.length ? this.rows.at(-1).t : 0;
    const x = (t) => left + (width - left - 4) * (1 + (t - end) / SPAN_S);
    ctx.font = "12px system-ui, sans-serif";
    STRIPS.forEach((strip, i) => this.strip(ctx, strip, gap + i * (tall + gap), tall, x, left, width, ink));
    ctx.fillStyle = ink.quiet;
    for (let s = -SPAN_S; s <= 0; s += 15) {
      ctx.textAlign = s === 0 ? "right" : s === -SPAN_S ? "left" : "center";
      ctx.fillText(s === 0 ? "now" : `${s} s`, Math.min(x(end + s), width - 2), height - 3);
    }
  }

  strip(ctx, strip, top, tall, x, left, width, ink) {
    const values = this.rows.map((row) => row[strip.key]).filter((v) => v !== null);
    const most = values.length ? roundUp(Math.max(1e-4, 1e3 * values.reduce((a, b) => Math.max(a, b)) * 1.05)) : 1;
    const y = (v_mm) => top + tall * (1 - v_mm / most);
    ctx.strokeStyle = ink.line;
    ctx.lineWidth = 1;
    ctx.fillStyle = ink.quiet;
    ctx.textAlign = "right";
    for (const part of [0, 0.5, 1]) {
      const at = Math.round(y(part * most)) + 0.5;
      ctx.beginPath();
      ctx.moveTo(left, at);
      ctx.lineTo(width - 4, at);
      ctx.stroke();
      ctx.fillText(String(Number((part * most).toPrecision(3))), left - 6, at + 4);
    }
    ctx.textAlign = "left";
    ctx.fillText(strip.name, left, top - 8);
    ctx.strokeStyle = ink[strip.colour];
    ctx.lineWidth = 1.8;
    ctx.lineJoin = "round";
    ctx.beginPath();
    let pen = false;
    for (const row of this.rows) {
      const v = row[strip.key];
      if (v === null || v === undefined) { pen = false; continue; }
      if (pen) ctx.lineTo(x(row.t), y(1e3 * v));
      else ctx.moveTo(x(row.t), y(1e3 * v));
      pen = true;
    }
    ctx.stroke();
  }
}
