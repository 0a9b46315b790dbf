#!/usr/bin/env python3
"""Measures the cycle without the page, with it, and with a browser that shows it:

    page_times.py --program build/ci/apps/flextip [--seconds 20] [--rounds 3] [--rate 120 1000]

Each round has all three in turn, so that what else the machine does falls on all of them. The
virtual robot runs on the same machine, without a camera; it is not enabled (`--timing`).
"""
import argparse
import json
import os
import pathlib
import statistics
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from devtools import Browser  # noqa: E402
from live_run import LiveRun  # noqa: E402

WAYS = ("no page", "page, no browser", "page in Chromium")


def measure(program, way, seconds, rate_hz):
    """Returns the summary of one run."""
    with tempfile.TemporaryDirectory() as folder, \
            LiveRun(program, folder, page=way != WAYS[0], options=["--timing", seconds],
                    camera=False, rate_hz=rate_hz) as run:
        if way == WAYS[2]:
            with Browser() as browser:
                browser.open(run.address)
                if not browser.until("document.body.dataset.tNs"):
                    raise SystemExit("the page shows nothing")
                run.wait(seconds + 60)
        else:
            run.wait(seconds + 60)
        return json.loads((run.recording / "summary.json").read_text(encoding="utf-8"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--seconds", type=int, default=20)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--rate", type=int, nargs="+", default=[120, 1000])
    options = parser.parse_args()
    print(f"load at the start: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    for rate_hz in options.rate:
        runs = {way: [] for way in WAYS}
        for _ in range(options.rounds):
            for way in WAYS:
                runs[way].append(measure(options.program, way, options.seconds, rate_hz))
        for way, all_runs in runs.items():
            def middle(name, part, runs=all_runs):
                return 1e3 * statistics.median(run[name][part] for run in runs)
            cycles, missed = (sum(run[key] for run in all_runs) for key in ("cycles", "missed_cycles"))
            print(f"{rate_hz:5} Hz  {way:17} begun to sent p50 {middle('work', 'p50_s'):.3f} p99 "
                  f"{middle('work', 'p99_s'):.3f} ms, woken late p50 {middle('wake_late', 'p50_s'):.3f}"
                  f" p99 {middle('wake_late', 'p99_s'):.3f} ms, missed {missed} of {cycles}")
    print(f"load at the end: {os.getloadavg()[0]:.1f}")


if __name__ == "__main__":
    main()
