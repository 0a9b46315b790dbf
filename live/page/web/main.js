// The page of a running session: takes the newest state, shows all of it at once.
import { Connection, takeToken } from "./connection.js";
import { Controls } from "./controls.js";
import { clock, degrees, duration, mm, secondsSince, show, text } from "./format.js";
import { Picture } from "./picture.js";
import { Plots } from "./plots.js";
import { Orbit, View } from "./scene.js";
import { Sensors } from "./sensors.js";
import { eventWords, robotWords, stateWords } from "./words.js";

const $ = (id) => document.getElementById(id);
const MOST_WAY = 3000, MOST_EVENTS = 60, APART_M = 1e-4;
const ANGLE_WARN = 30, ANGLE_BAD = 60;  // degrees; at 90 the tip may go the wrong way

let session = null, state = null, firstNs = null, heard = performance.now(), dirty = false;
let way = [], events = [];
const orbit = new Orbit();
const views = [new View($("whole"), orbit, false), new View($("near"), orbit, true)];
const plots = new Plots($("plots"));
const sensors = new Sensors($("sensors"));
const picture = new Picture($("picture"), $("no-picture"), $("picture-legend"), $("overlay"));
const connection = new Connection({
  hello, state: take, picture: (m, jpeg) => picture.take(m, jpeg),
  answer: (m) => controls.answer(m), changed: () => { dirty = true; },
});
const controls = new Controls(takeToken(), (what, token) => connection.wish(what, token));

function hello(message) {
  session = message.session;
  $("session").textContent = `flextip · ${session.file} · ${session.controller} · ` +
    (session.lockstep ? "in lockstep" : `${session.rate_hz} Hz`);
  const { history } = message;
  firstNs = history.t_ns[0] || null;
  plots.reset(history.t_ns.map((t, i) => ({
    t: secondsSince(firstNs, t), deviation_m: history.deviation_m[i], sd_m: history.sd_m[i] })));
  way = history.way_m;
  events = [];
  addEvents(message.events);
  picture.begin(session);
  controls.begin(session);
  dirty = true;
}

function take(message) {
  state = message;
  heard = performance.now();
  firstNs = firstNs || state.t_ns;
  plots.add({ t: secondsSince(firstNs, state.t_ns), deviation_m: state.deviation_m,
    sd_m: state.estimate.sd_m === undefined ? null : state.estimate.sd_m });
  const p = state.tip_m, last = way.at(-1);
  if (p && (!last || Math.hypot(p[0] - last[0], p[1] - last[1], p[2] - last[2]) > APART_M)) way.push(p);
  if (way.length > MOST_WAY) way = way.filter((_, i) => i % 2 === 0);
  addEvents(state.events);
  dirty = true;
}

function addEvents(newer) {
  const last = events.length ? events.at(-1).n : 0;
  const added = newer.filter((event) => event.n > last);
  if (!added.length) return;
  events = events.concat(added).slice(-MOST_EVENTS);
  $("events").replaceChildren(...events.slice().reverse().map((event) => {
    const li = document.createElement("li");
    li.className = event.kind;
    li.append(Object.assign(document.createElement("time"), { textContent: clock(event.t_ns) }), eventWords(event));
    return li;
  }));
}

/// The path's legs in R, as far as they are known.
function pathOf() {
  if (!session || !session.path) return [];
  if (session.path === "R") return (state.start_m ? [state.start_m] : []).concat(session.waypoints_m);
  if (!state.start_m) return [];
  return [state.start_m].concat(session.waypoints_m.map((w) => w.map((v, i) => v + state.start_m[i])));
}

function showFigures() {
  const { estimate, worst } = state;
  show($("deviation"), mm(state.deviation_m ?? NaN), state.deviation_m);
  show($("sd"), mm(estimate.sd_m ?? NaN), estimate.sd_m ?? null);
  const angle = worst ? degrees(worst.angle_rad) : NaN;
  show($("worst"), Number.isFinite(angle) ? `${text(angle, angle < 10 ? 1 : 0)}°` : "–", worst ? worst.angle_rad : null);
  if (worst) {
    show($("worst-note"), worst.angle_rad > 3.1415 ? "a shaft within the doubt buckles or turns round"
      : `between wished and actual motion, within ${worst.deviations} standard deviation${worst.deviations === 1 ? "" : "s"}`);
  }
  $("worst-box").className = angle >= ANGLE_BAD ? "bad" : angle >= ANGLE_WARN ? "warn" : "";
  const force = estimate.force_N ? Math.hypot(...estimate.force_N) : NaN;
  show($("force"), Number.isFinite(force) ? `${text(force, 2)} N` : "–");
  show($("robot"), robotWords(state.robot));
  show($("limited"), state.limited.length ? `limited: ${state.limited.join(", ")}` : "no limit acts");
  show($("work"), duration(state.work_s ?? NaN), state.work_s);
  show($("cycles"), `begun to sent; ${state.cycles} cycles, ${state.missed} missed`, state.cycles);
}

/// A row of three numbers, each with the exact one behind it.
function showPlaces() {
  const body = $("places").tBodies[0];
  for (const [name, p] of [["wrist", state.wrist_m], ["command", state.command_m], ["tip", state.tip_m],
    ["goal", state.goal_m], ["tip, seen", state.seen_m]]) {
    let row = body.querySelector(`[data-place="${name}"]`);
    if (!row) {
      row = body.insertRow();
      row.dataset.place = name;
      row.insertCell().textContent = name;
      for (let i = 0; i < 3; ++i) row.insertCell();
    }
    for (let i = 0; i < 3; ++i) show(row.cells[i + 1], p ? (1e3 * p[i]).toFixed(2) : "–", p ? p[i] : null);
  }
}

function update() {
  const words = stateWords(state, connection.connected, (performance.now() - heard) / 1e3);
  document.body.dataset.mood = words.mood;
  show($("title"), words.title);
  show($("reason"), words.reason);
  document.title = `${words.title} · flextip`;
  controls.update(state, connection.connected);
  if (!state) return;
  showFigures();
  showPlaces();
  sensors.update(state.streams);
  const tip = state.tip_m || null;
  const scene = { shaft: state.shaft_m, end: state.shaft_m.at(-1) || null, wrist: state.wrist_m,
    port: state.estimate.port_m || (session && session.port_m), tip, goal: state.goal_m, path: pathOf(), way,
    workspace: session && session.workspace };
  for (const view of views) view.draw(scene);
  plots.draw();
  document.body.dataset.tNs = state.t_ns;  // all above is of this time
  document.body.dataset.hold = state.hold;
  document.body.dataset.end = state.end;
}

function frame() {
  if (dirty) {
    dirty = false;
    update();
  }
  requestAnimationFrame(frame);
}

for (const view of views) orbit.follow(view, () => { dirty = true; });
window.addEventListener("resize", () => { dirty = true; });
setInterval(() => { dirty = true; }, 500);  // time goes on without news
requestAnimationFrame(frame);
