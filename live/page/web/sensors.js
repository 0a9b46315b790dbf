// Each stream's age against its limit, and its rate.
import { duration, show, text } from "./format.js";
import { streamWords } from "./words.js";

const NEAR = 0.6;  // of the limit

export class Sensors {
  constructor(table) {
    this.body = table.tBodies[0];
    this.rows = new Map();
  }

  row(name) {
    if (this.rows.has(name)) return this.rows.get(name);
    const tr = this.body.insertRow();
    tr.dataset.stream = name;
    const first = tr.insertCell();
    first.append(name, Object.assign(document.createElement("small"), { textContent: streamWords(name) }));
    const age = tr.insertCell();
    age.className = "age";
    const bar = Object.assign(document.createElement("div"), { className: "bar" });
    const fill = document.createElement("b");
    bar.append(fill);
    const words = document.createElement("small");
    age.append(bar, words);
    const row = { tr, fill, words, rate: tr.insertCell() };
    this.rows.set(name, row);
    return row;
  }

  update(streams) {
    for (const stream of streams) {
      const row = this.row(stream.name);
      const part = stream.age_s === null ? 1 : Math.max(0, stream.age_s) / stream.limit_s;
      row.tr.classList.toggle("over", part >= 1 || stream.lost);
      row.tr.classList.toggle("near-limit", part >= NEAR && part < 1 && !stream.lost);
      row.fill.style.width = `${100 * Math.min(1, part)}%`;
      let words = `${duration(stream.age_s)} of ${duration(stream.limit_s)}`;
      if (stream.age_s === null) words = "nothing came yet";
      if (stream.lost) words = "the sender is gone";
      show(row.words, words, stream.age_s);
      show(row.rate, stream.rate_hz > 0 ? `${text(stream.rate_hz, stream.rate_hz < 10 ? 1 : 0)} Hz` : "–");
    }
  }
}
