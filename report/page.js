// Draws every plot of the page from the JSON inside its element.
(function () {
  "use strict";
  // Colours that the colour-blind can tell apart (Okabe and Ito), darkened where white would swallow them.
  const COLORS = ["#0072b2", "#d55e00", "#009e73", "#b0578d", "#b88700", "#3a9bd6", "#555f6b"];
  const INK = "#1d2733", GRID = "#e3e8ed";
  const FONT = { family: 'system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif', size: 13, color: INK };

  function axis(title, extra) {
    return Object.assign({ title: { text: title, font: { size: 13 } }, gridcolor: GRID, zerolinecolor: "#b9c2cc",
      linecolor: "#9aa5b1", automargin: true }, extra);
  }

  function trace(t, i) {
    const color = t.color || COLORS[i % COLORS.length];
    const inSpace = t.z !== undefined;
    const out = { type: inSpace ? "scatter3d" : "scatter", mode: t.markers ? "markers" : "lines", name: t.name,
      x: t.x, y: t.y, line: { color: color, width: inSpace ? 5 : 2, dash: t.dashed ? "dash" : "solid" },
      marker: { color: color, size: inSpace ? 3 : 5 } };
    if (inSpace) out.z = t.z;
    return out;
  }

  function range(traces, key) {
    let low = Infinity, high = -Infinity;
    for (const t of traces) for (const v of t[key]) if (v !== null) { low = Math.min(low, v); high = Math.max(high, v); }
    return [low, high];
  }

  // Equal scales on the three axes, without a flat path becoming a slit.
  function cube(traces) {
    const ranges = ["x", "y", "z"].map((k) => range(traces, k));
    const longest = Math.max(...ranges.map((r) => r[1] - r[0])) || 1;
    const spans = ranges.map((r) => Math.max(r[1] - r[0], 0.25 * longest) * 1.08);
    const around = (r, s) => [(r[0] + r[1] - s) / 2, (r[0] + r[1] + s) / 2];
    return { ranges: ranges.map((r, i) => around(r, spans[i])), ratio: spans.map((s) => 1.6 * s / Math.hypot(...spans)) };
  }

  function layout(plot, inSpace) {
    const common = { font: FONT, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      showlegend: plot.traces.length > 1, hoverlabel: { font: FONT },
      modebar: { bgcolor: "rgba(0,0,0,0)", color: "#b9c2cc", activecolor: INK } };
    if (!inSpace) {
      const shapes = (plot.bands || []).map((b) => ({ type: "rect", layer: "below", xref: "x", yref: "paper",
        x0: b.from, x1: b.to, y0: 0, y1: 1, fillcolor: b.color, opacity: 0.18, line: { width: 0 } }));
      return Object.assign(common, { shapes: shapes, margin: { l: 60, r: 16, t: 10, b: 48 }, hovermode: plot.traces.some((t) => t.markers) ? "closest" : "x unified",
        legend: { orientation: "h", y: 1.02, yanchor: "bottom", x: 0 },
        xaxis: axis(plot.x_label, {}),
        yaxis: axis(plot.y_label, plot.log_y ? { type: "log", exponentformat: "power" } : {}) });
    }
    const box = cube(plot.traces);
    const side = (label, i) => axis(label, { range: box.ranges[i], showbackground: false });
    return Object.assign(common, { margin: { l: 0, r: 0, t: 0, b: 0 },
      legend: { orientation: "h", y: 1.0, yanchor: "top", x: 0 },
      scene: { domain: { x: [0, 1], y: [0, 0.93] }, xaxis: side(plot.x_label, 0), yaxis: side(plot.y_label, 1), zaxis: side(plot.z_label, 2),
        aspectmode: "manual", aspectratio: { x: box.ratio[0], y: box.ratio[1], z: box.ratio[2] },
        camera: { eye: { x: 1.15, y: -1.5, z: 0.8 }, center: { x: 0, y: 0, z: -0.1 } } } });
  }

  document.querySelectorAll(".canvas").forEach(function (element) {
    const plot = JSON.parse(element.querySelector("script").textContent);
    const inSpace = plot.traces.some((t) => t.z !== undefined);
    Plotly.newPlot(element, plot.traces.map(trace), layout(plot, inSpace),
      { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d"] });
  });
})();
