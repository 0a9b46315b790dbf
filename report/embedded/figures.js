// Draws every figure of the page from the JSON inside its element.
(function () {
  "use strict";
  const COLORS = ["#0072b2", "#d55e00", "#009e73", "#b0578d", "#b88700", "#3a9bd6", "#555f6b"];
  const INK = "#1d2733", GRID = "#e3e8ed";
  const FONT = { family: 'system-ui, "Segoe UI", Roboto, "DejaVu Sans", sans-serif', size: 13, color: INK };
  const FIELD_COLORS = [[0, "#f7fbff"], [0.25, "#cfe1f2"], [0.5, "#93c4de"], [0.75, "#4a97c9"], [1, "#1763aa"]];

  function axis(title, log) {
    const out = { title: { text: title, font: { size: 13 } }, gridcolor: GRID, zerolinecolor: "#b9c2cc",
      linecolor: "#9aa5b1", automargin: true };
    if (log) Object.assign(out, { type: "log", exponentformat: "power" });
    return out;
  }

  function field(f) {
    const colors = { type: "heatmap", x: f.x, y: f.y, z: f.values, colorscale: FIELD_COLORS, zsmooth: f.cells ? false : "best", hoverongaps: false,
      colorbar: { title: { text: f.name, side: "right" }, thickness: 12, outlinewidth: 0 }, showscale: true };
    if (f.cells) Object.assign(colors, { texttemplate: "%{z}", xgap: 1, ygap: 1 });
    if (f.low !== null) colors.zmin = f.low;
    if (f.high !== null) colors.zmax = f.high;
    if (f.low !== null || f.high !== null) colors.zauto = false;
    const lines = f.levels.map((level) => ({ type: "contour", x: f.x, y: f.y, z: f.values, autocontour: false, showscale: false, hoverinfo: "skip",
      contours: { start: level, end: level, size: 1, coloring: "none", showlabels: true, labelfont: { size: 11, color: INK } },
      line: { color: INK, width: 1.2 }, connectgaps: false, showlegend: false }));
    return [colors].concat(lines);
  }

  function trace(t, i, lying) {
    if (t.z) return pathInSpace(t, i);
    const color = t.color || COLORS[i % COLORS.length];
    const out = { name: t.name, showlegend: t.name !== "", x: t.x, y: t.y };
    if (t.kind === "bars") Object.assign(out, { type: "bar", marker: { color: t.colors || color }, textposition: "outside", cliponaxis: false });
    else Object.assign(out, { type: "scatter", mode: t.kind === "points" ? "markers" : "lines", connectgaps: false,
      line: { color: color, width: t.width || 2, dash: t.dashed ? "dash" : "solid" },
      marker: { color: color, size: t.y.length > 200 ? 4 : 8, symbol: t.symbol || "circle", line: { color: color, width: t.y.length > 200 ? 1 : 2 } } });
    if (t.kind === "bars" && lying) Object.assign(out, { orientation: "h", x: t.y, y: t.x });
    if (t.texts) out.text = t.texts;
    if (t.texts && t.kind === "points") Object.assign(out, { mode: "markers+text", textposition: "top right", cliponaxis: false });
    if (t.arrow) Object.assign(out, { mode: "lines+markers", marker: { color: color, symbol: "arrow", angleref: "previous", size: t.x.map((x, k) => k === t.x.length - 1 ? 14 : 0) } });
    if (t.y_error) out.error_y = { type: "data", array: t.y_error, visible: true, color: INK, thickness: 1.2 };
    return out;
  }

  function pathInSpace(t, i) {
    const color = t.color || COLORS[i % COLORS.length];
    return { type: "scatter3d", mode: t.kind === "points" ? "markers" : "lines", name: t.name, x: t.x, y: t.y, z: t.z,
      line: { color: color, width: 5, dash: t.dashed ? "dash" : "solid" }, marker: { color: color, size: 3 } };
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

  function spaceLayout(figure) {
    const box = cube(figure.traces);
    const side = (label, i) => Object.assign(axis(label), { range: box.ranges[i], showbackground: false });
    return { font: FONT, paper_bgcolor: "rgba(0,0,0,0)", margin: { l: 0, r: 0, t: 0, b: 0 }, hoverlabel: { font: FONT },
      showlegend: figure.traces.length > 1, legend: { orientation: "h", y: 1.0, yanchor: "top", x: 0 },
      modebar: { bgcolor: "rgba(0,0,0,0)", color: "#b9c2cc", activecolor: INK },
      scene: { domain: { x: [0, 1], y: [0, 0.93] }, xaxis: side(figure.x_label, 0), yaxis: side(figure.y_label, 1), zaxis: side(figure.z_label, 2),
        aspectmode: "manual", aspectratio: { x: box.ratio[0], y: box.ratio[1], z: box.ratio[2] },
        camera: { eye: { x: 1.15, y: -1.5, z: 0.8 }, center: { x: 0, y: 0, z: -0.1 } } } };
  }

  // A single curve needs no legend: the title says what it is.
  function hasLegend(figure) {
    return figure.traces.some((t) => t.name !== "") && figure.traces.length + figure.fields.length > 1;
  }

  function layout(figure) {
    if (figure.traces.some((t) => t.z)) return spaceLayout(figure);
    const legend = hasLegend(figure);
    const overTime = figure.x_label.startsWith("time (") && figure.traces.every((t) => t.kind === "line");
    const bands = (figure.bands || []).map((b) => Object.assign({ xref: "x", yref: "paper", x0: b.from, x1: b.to, y0: 0, y1: 1 }, b.from === b.to
      ? { type: "line", layer: "above", line: { color: b.color, width: 2, dash: "dash" } }
      : { type: "rect", layer: "below", fillcolor: b.color, opacity: 0.18, line: { width: 0 } }));
    const out = { font: FONT, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", margin: { l: 60, r: 16, t: legend ? 64 : 34, b: 48 },
      shapes: bands, showlegend: legend, legend: { orientation: "h", y: 1.01, yanchor: "bottom", x: 0 }, hoverlabel: { font: FONT }, hovermode: overTime ? "x unified" : "closest",
      barmode: "group", modebar: { bgcolor: "rgba(0,0,0,0)", color: "#b9c2cc", activecolor: INK },
      xaxis: axis(figure.x_label, figure.log_x), yaxis: axis(figure.y_label, figure.log_y) };
    const constrain = isLongAndFlat(figure) ? "range" : "domain";
    if (figure.equal_axes) Object.assign(out.yaxis, { scaleanchor: "x", constrain }), out.xaxis.constrain = constrain;
    if (figure.y_down || figure.lying_bars) out.yaxis.autorange = "reversed";
    if (figure.y_names) Object.assign(out.yaxis, { tickvals: figure.y_names.map((n, i) => i), ticktext: figure.y_names, showgrid: false, zeroline: false,
      autorange: false, range: [figure.y_names.length - 0.4, -0.6] });
    if (figure.lying_bars) out.margin.r = 60;  // for the longest bar's text
    if (figure.lying_bars) Object.assign(out.yaxis, { type: "category", showgrid: false }), out.xaxis.rangemode = "tozero";
    return out;
  }

  // Room for each bar, whatever their number.
  function lyingHeight(figure) {
    return 130 + figure.traces.reduce((sum, t) => sum + 26 * t.y.length, 0);
  }

  // What is drawn to scale needs no more height than it has itself.
  function isLongAndFlat(figure) {
    return figure.equal_axes && figure.fields.length === 0 && figure.traces.length > 0 && !figure.traces[0].z && flatness(figure) < 0.5;
  }

  function flatness(figure) {
    const span = (r) => r[1] - r[0];
    return span(range(figure.traces, "y")) / (span(range(figure.traces, "x")) || 1);
  }

  function flatHeight(figure, width) {
    return 160 + Math.max(0.2, 1.2 * flatness(figure)) * (width - 76);
  }

  document.querySelectorAll(".drawing").forEach(function (element) {
    const figure = JSON.parse(element.querySelector("script").textContent);
    const traces = figure.fields.flatMap(field).concat(figure.traces.map((t, i) => trace(t, i, figure.lying_bars)));
    if (figure.lying_bars) element.style.height = lyingHeight(figure) + "px";
    if (figure.y_names) element.style.height = 130 + 38 * figure.y_names.length + "px";
    if (isLongAndFlat(figure)) element.style.height = Math.min(element.clientHeight, flatHeight(figure, element.clientWidth)) + "px";
    Plotly.newPlot(element, traces, layout(figure), { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d"] });
  });
})();
