// Numbers as text, and elements that keep the exact number beside the text they show.

export const degrees = (rad) => rad * 180 / Math.PI;

/// "0.42" for 0.4237 and 2 digits; a dash where there is no number.
export function text(value, digits) {
  return Number.isFinite(value) ? value.toFixed(digits) : "–";
}

/// Millimetres with as many digits as are worth reading.
export function mm(value_m) {
  if (!Number.isFinite(value_m)) return "–";
  const v = 1e3 * value_m;
  return `${v.toFixed(Math.abs(v) < 10 ? 2 : 1)} mm`;
}

export function duration(s) {
  if (!Number.isFinite(s)) return "–";
  if (s < 0.0995) return `${(1e3 * s).toFixed(s < 0.00995 ? 1 : 0)} ms`;
  return `${s.toFixed(s < 9.95 ? 1 : 0)} s`;
}

/// Shows `shown` and keeps `value` as it came, to the last bit, in data-value.
export function show(element, shown, value) {
  if (element.textContent !== shown) element.textContent = shown;
  if (value === undefined) return;
  const exact = value === null ? "" : String(value);
  if (element.dataset.value !== exact) element.dataset.value = exact;
}

/// A number of nanoseconds (text: it has more digits than a number keeps) as a clock time.
export function clock(t_ns) {
  const ms = Number(BigInt(t_ns) / 1000000n);
  return new Date(ms).toTimeString().slice(0, 8);
}

/// Seconds from `from_ns` to `t_ns`, both texts.
export function secondsSince(from_ns, t_ns) {
  return Number(BigInt(t_ns) - BigInt(from_ns)) * 1e-9;
}
