#!/usr/bin/env python3
"""Looks at the page of a running session in Chromium, as a person does:

    browser_test.py --program build/ci/apps/flextip --work FOLDER [--controller rod-track]

The virtual robot is steered in lockstep, with its laparoscope. What the page shows of some cycles
is compared with the rows that the recording has of them.
"""
import argparse
import csv
import math
import pathlib
import shutil
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "scripts"))
from devtools import Browser  # noqa: E402
from live_run import LiveRun  # noqa: E402

HOLDS = ("none", "bad_time", "source_lost", "stale_wrist", "stale_tip", "not_enabled", "resuming",
         "starting", "no_goal", "no_command", "not_finite", "stopped", "delay_unknown",
         "tip_jump", "tip_disagrees", "model_disagrees", "wrist_not_following", "port_moved",
         "port_depth", "force", "motion_angle", "tip_astray", "deadline")
ROBOT = ("disabled", "enabled", "paused", "FAULT")
# All at once, so that every number is of one cycle: page's scripts change all of it in one go.
SEEN = """(() => {
  const numbers = (row) => [...row.cells].slice(1).map((cell) => ({
    shown: cell.textContent, exact: cell.dataset.value }));
  const figure = (id) => ({ shown: document.getElementById(id).textContent,
    exact: document.getElementById(id).dataset.value });
  return {
    t_ns: document.body.dataset.tNs, hold: document.body.dataset.hold,
    title: figure("title").shown, robot: figure("robot").shown,
    deviation: figure("deviation"), sd: figure("sd"), worst: figure("worst"), work: figure("work"),
    cycles: figure("cycles").exact,
    places: Object.fromEntries([...document.querySelectorAll("#places tbody tr")].map(
      (row) => [row.dataset.place, numbers(row)])),
    sensors: Object.fromEntries([...document.querySelectorAll("#sensors tbody tr")].map(
      (row) => [row.dataset.stream, { age:
        row.querySelector("td.age small").dataset.value, rate: row.cells[2].textContent }])),
    picture: { t_ns: document.getElementById("picture").dataset.tNs,
      tags: document.getElementById("picture").dataset.tags },
  };
})()"""
# Colours in a canvas: an empty one has one.
COLOURS = """((id) => {
  const canvas = document.getElementById(id);
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return new Set(new Uint32Array(data.buffer)).size;
})"""
ERRORS = """window.errors = [];
addEventListener("error", (event) => errors.push(String(event.message)));
addEventListener("unhandledrejection", (event) => errors.push(String(event.reason)));"""


def cycles_of(recording):
    """Returns time (text) -> row of cycles.csv; a sample that stayed the same is filled in."""
    with open(recording / "session0/cycles.csv", newline="", encoding="utf-8") as text:
        rows = list(csv.reader(text))
    names = [name.lstrip("#").strip() for name in rows[0]]
    cycles, last = {}, {}
    for number, row in enumerate(rows[1:], 1):
        cycle = dict(zip(names, row))
        for stream in ("wrist0", "vision0", "em0", "em1", "strain0", "load0", "state"):
            fields = [name for name in names if name == stream or name.startswith(stream + " ")]
            if cycle[f"{stream} t [ns]"]:
                last[stream] = {name: cycle[name] for name in fields}
            cycle.update(last.get(stream, {}))
        cycle["number"] = number
        cycles[cycle["timestamp [ns]"]] = cycle
    return cycles


class PageInABrowser(unittest.TestCase):
    program = work = controller = None

    def press(self, browser, button, times=1):
        """All clicks at once: on a slow machine one by one would come after the page's 4 s."""
        browser.value(f"document.getElementById('{button}').click();" * times)

    def watch(self, browser, samples):
        """Looks at cycles that follow one another until there are so many."""
        seen = []
        while len(seen) < samples:
            last = seen[-1]["t_ns"] if seen else ""
            self.assertTrue(browser.until(f"document.body.dataset.tNs !== '{last}'"))
            seen.append(browser.value(SEEN))
        return seen

    def refuses(self, browser, address):
        """Without the token, and with another, the buttons do nothing and a wish is refused."""
        root = address.split("?")[0]
        browser.open(root)
        self.assertTrue(browser.until("document.body.dataset.tNs"))
        for button in ("enable", "pause", "stop"):
            self.assertTrue(browser.value(f"document.getElementById('{button}').disabled"))
        browser.open(root + "?token=" + "0" * 32)
        self.assertTrue(browser.until("!document.getElementById('enable').disabled"))
        self.press(browser, "enable", 2)
        answer = "document.getElementById('answer').textContent"
        self.assertTrue(browser.until(answer + ".startsWith('Refused')"), browser.value(answer))
        self.assertEqual(browser.value("location.search"), "")
        self.assertNotIn("person", browser.value("document.getElementById('events').textContent"))

    def test_shows_what_is_recorded_and_lets_its_token_act(self):
        shutil.rmtree(self.work, ignore_errors=True)
        self.work.mkdir(parents=True)
        with LiveRun(self.program, self.work, options=["--wait"], lockstep=True, rate_hz=30,
                     speed_m_s=0.0005, waypoints="[{to_m: [0, 0, -0.02]}]",
                     kind=self.controller) as run, \
                Browser() as browser:
            browser.open("about:blank")
            browser.call("Page.addScriptToEvaluateOnNewDocument", source=ERRORS)
            self.refuses(browser, run.address)
            waiting = self.watch(browser, 3)
            browser.open(run.address)
            self.assertTrue(browser.until("!document.getElementById('enable').disabled"))
            self.press(browser, "enable", 2)
            self.assertTrue(browser.until("document.body.dataset.hold === 'none'", 60))
            moving = self.watch(browser, 10)
            self.assertTrue(browser.until("document.getElementById('picture').dataset.tags > 0"))
            moving += self.watch(browser, 10)
            colours = {name: browser.value(f"{COLOURS}('{name}')")
                       for name in ("whole", "near", "plots", "picture")}
            errors = browser.value("window.errors")
            browser.picture(self.work / "page.png")
            self.press(browser, "stop")
            self.assertEqual(run.wait(60), 0)
        self.assertIn("the robot is not enabled", run.said)
        self.assertEqual(errors, [])
        for name, count in colours.items():
            self.assertGreater(count, 20, name)
        self.assertGreater((self.work / "page.png").stat().st_size, 20_000)
        cycles = cycles_of(run.recording)
        for seen in waiting + moving:
            self.compare(seen, cycles)
        for seen in waiting:
            self.assertEqual((seen["hold"], seen["robot"]), ("not_enabled", "disabled, not homed"))
        self.assertEqual({seen["hold"] for seen in moving}, {"none"})
        self.compare_deviation(moving[-10:], cycles)
        self.compare_pictures(moving[-10:], cycles)
        events = (run.recording / "session0/events.csv").read_text(encoding="utf-8")
        self.assertEqual(events.count("a person at the page: enable"), 1)
        self.assertEqual(events.count("a person at the page: stop"), 1)

    def compare(self, seen, cycles):
        """Every number to the last bit, and the text beside it to its last digit."""
        cycle = cycles[seen["t_ns"]]
        self.assertEqual(seen["hold"], HOLDS[int(cycle["hold"])])
        self.assertEqual(seen["cycles"], str(cycle["number"]))
        self.assertTrue(seen["robot"].startswith(ROBOT[int(cycle["state"])]), seen["robot"])
        for place, name in (("wrist", "wrist0 p_RW"), ("command", "command [m]"),
                            ("tip", "p_RE [m]"), ("goal", "goal [m]"),
                            ("tip, seen", "vision0 p_RE")):
            known = place not in ("tip", "goal") or seen["hold"] == "none"
            for axis, cell in enumerate(seen["places"][place]):
                recorded = cycle.get(f"{name}_{axis}", "") if known else ""
                if recorded == "":
                    self.assertEqual((cell["shown"], cell["exact"]), ("–", ""))
                    continue
                self.assertEqual(float(cell["exact"]), float(recorded), f"{place} {axis}")
                self.assertLessEqual(abs(float(cell["shown"]) - 1e3 * float(recorded)), 0.00501)
        work_s = 1e-9 * (int(cycle["sent [ns]"]) - int(cycle["woke [ns]"]))
        self.assertAlmostEqual(float(seen["work"]["exact"]), work_s, delta=1e-12)
        for stream in ("wrist0", "em0", "strain0"):
            age_s = 1e-9 * (int(seen["t_ns"]) - int(cycle[f"{stream} t [ns]"]))
            self.assertAlmostEqual(float(seen["sensors"][stream]["age"]), age_s, delta=1e-12)

    def compare_deviation(self, looks, cycles):
        """The path is straight down: off it is whatever the recorded tip is beside its goal, or
        how far it is from the path's start where it is above. The first goal is at most one cycle
        below the start."""
        top = max(float(c["goal [m]_2"]) for c in cycles.values() if c["goal [m]_2"])
        cycle_m = 0.0005 / 30
        for seen in looks:
            cycle = cycles[seen["t_ns"]]
            off = math.hypot(*(float(cycle[f"p_RE [m]_{axis}"]) - float(cycle[f"goal [m]_{axis}"])
                               for axis in (0, 1)))
            shown = float(seen["deviation"]["exact"])
            above = float(cycle["p_RE [m]_2"]) - top
            self.assertGreaterEqual(shown, math.hypot(off, max(0.0, above - cycle_m)) - 1e-9)
            self.assertLessEqual(shown, math.hypot(off, max(0.0, above)) + 1e-9)
            self.assertGreater(float(seen["sd"]["exact"]), 0.0)
            self.assertLess(float(seen["sd"]["exact"]), 0.005)
            self.assertGreater(float(seen["worst"]["exact"]), 0.0)
            for stream, rate_hz in (("wrist0", 120), ("vision0", 30)):
                shown = float(seen["sensors"][stream]["rate"].split()[0])
                self.assertLess(abs(shown - rate_hz), 0.1 * rate_hz, stream)

    def compare_pictures(self, looks, cycles):
        """The picture is of the time of a tip that a cycle was given."""
        tips = {cycle.get("vision0 t [ns]") for cycle in cycles.values()}
        for seen in looks:
            self.assertIn(seen["picture"]["t_ns"], tips)
            self.assertGreater(int(seen["picture"]["tags"]), 0)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    parser.add_argument("--controller", default="rod-track")
    options, rest = parser.parse_known_args()
    PageInABrowser.program, PageInABrowser.work = options.program, options.work
    PageInABrowser.controller = options.controller
    unittest.main(argv=[sys.argv[0], *rest])
