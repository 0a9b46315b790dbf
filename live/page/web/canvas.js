// A canvas in the screen's own pixels, and the style sheet's colours.

/// Fits the canvas to its place and clears it. Returns { ctx, width, height } in CSS pixels.
export function fit(canvas) {
  const ratio = window.devicePixelRatio || 1;
  const width = canvas.clientWidth, height = canvas.clientHeight;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const ctx = canvas.getContext("2d");
  ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
  ctx.clearRect(0, 0, width, height);
  return { ctx, width, height };
}

const NAMES = ["ink", "quiet", "line", "paper", "shaft", "tip", "goal", "path", "way", "port", "wrist", "tags"];
let kept = null;

/// Returns the colours by their names; read again when light turns to dark.
export function colours() {
  if (kept) return kept;
  const style = getComputedStyle(document.documentElement);
  kept = Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
  return kept;
}

matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { kept = null; });
