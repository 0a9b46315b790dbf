// Draws the figures of figures.json, each in the element that holds it.
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
    const colors = { type: "heatmap", x: f.x, y: f.y, z: f.values, colorscale: FIELD_COLORS, zsmooth: "best", hoverongaps: false,
      colorbar: { title: { text: f.name, side: "right" }, thickness: 12, outlinewidth: 0 }, showscale: true };
    if (f.low !== null) colors.zmin = f.low;
    if (f.high !== null) colors.zmax = f.high;
    if (f.low !== null || f.high !== null) colors.zauto = false;
    const lines = f.levels.map((level) => ({ type: "contour", x: f.x, y: f.y, z: f.values, autocontour: false, showscale: false, hoverinfo: "skip",
      contours: { start: level, end: level, size: 1, coloring: "none", showlabels: true, labelfont: { size: 11, color: INK } },
      line: { color: INK, width: 1.2 }, connectgaps: false, showlegend: false }));
    return [colors].concat(lines);
  }

  function trace(t, i) {
    const color = t.color || COLORS[i % COLORS.length];
    const out = { name: t.name, showlegend: t.name !== "", x: t.x, y: t.y };
    if (t.kind === "bars") Object.assign(out, { type: "bar", marker: { color: color } });
    else Object.assign(out, { type: "scatter", mode: t.kind === "points" ? "markers" : "lines", connectgaps: false,
      line: { color: color, width: 2, dash: t.dashed ? "dash" : "solid" },
      marker: { color: color, size: t.y.length > 200 ? 4 : 8, symbol: t.symbol || "circle", line: { color: color, width: t.y.length > 200 ? 1 : 2 } } });
    if (t.y_error) out.error_y = { type: "data", array: t.y_error, visible: true, color: INK, thickness: 1.2 };
    return out;
  }

  function layout(figure) {
    const named = figure.traces.filter((t) => t.name !== "").length;
    const out = { font: FONT, paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", margin: { l: 60, r: 16, t: named > 0 ? 64 : 34, b: 48 },
      showlegend: named > 0, legend: { orientation: "h", y: 1.01, yanchor: "bottom", x: 0 }, hoverlabel: { font: FONT }, hovermode: "closest",
      barmode: "group", modebar: { bgcolor: "rgba(0,0,0,0)", color: "#b9c2cc", activecolor: INK },
      xaxis: axis(figure.x_label, figure.log_x), yaxis: axis(figure.y_label, figure.log_y) };
    if (figure.equal_axes) Object.assign(out.yaxis, { scaleanchor: "x", constrain: "domain" }), out.xaxis.constrain = "domain";
    if (figure.y_down) out.yaxis.autorange = "reversed";
    return out;
  }

  document.querySelectorAll(".drawing").forEach(function (element) {
    const figure = JSON.parse(element.querySelector("script").textContent);
    const traces = figure.fields.flatMap(field).concat(figure.traces.map(trace));
    Plotly.newPlot(element, traces, layout(figure), { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["select2d", "lasso2d"] });
  });
})();
