// Two halves of scripts/pictures: "page FIGURES" prints a page that draws every figure and keeps it
// as SVG in its element; "save DOM FOLDER" writes those SVG files from the page as it ended.
const fs = require("fs");
const path = require("path");

const WIDTH = 760, HEIGHT = 500, TALL = 560;

function page(file) {
  const root = path.join(__dirname, "..");
  const plotly = fs.readFileSync(path.join(root, "node_modules/plotly.js-cartesian-dist-min/plotly-cartesian.min.js"), "utf8");
  const drawing = fs.readFileSync(path.join(root, "report/figures.js"), "utf8");
  const figures = JSON.parse(fs.readFileSync(file, "utf8"));
  const elements = figures.map((f) => {
    const height = f.equal_axes ? TALL : HEIGHT;
    const json = JSON.stringify(f).replace(/</g, "\\u003c");
    return `<div class="drawing" data-name="${f.name}" style="width:${WIDTH}px;height:${height}px"><script type="application/json">${json}</script></div>`;
  });
  const keep = `(async function () {
    for (const e of document.querySelectorAll(".drawing")) {
      const url = await Plotly.toImage(e, { format: "svg", width: ${WIDTH}, height: e.clientHeight });
      const kept = document.createElement("i");
      kept.dataset.file = e.dataset.name;
      const svg = unescape(url.slice(url.indexOf(",") + 1));
      kept.dataset.svg = btoa(svg.replace("<svg ", '<svg style="background:#fff" ').replace(' style="" ', " "));
      document.body.appendChild(kept);
      e.remove();
    }
  })();`;
  process.stdout.write(`<!DOCTYPE html><meta charset="utf-8"><body style="background:#fff">${elements.join("\n")}<script>${plotly}</script><script>${drawing}</script><script>${keep}</script></body>`);
}

function save(dom, folder) {
  const text = fs.readFileSync(dom, "utf8");
  let count = 0;
  for (const [, name, svg] of text.matchAll(/<i data-file="([^"]+)" data-svg="([^"]+)"/g)) {
    fs.writeFileSync(path.join(folder, name + ".svg"), Buffer.from(svg, "base64"));
    ++count;
  }
  console.log(`${count} pictures in ${folder}`);
  if (count === 0) process.exit(1);
}

const [, , what, first, second] = process.argv;
if (what === "page") page(first);
else save(first, second);
