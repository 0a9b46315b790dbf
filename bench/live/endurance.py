#!/usr/bin/env python3
"""Steers the virtual robot for a long time, and says what grew, what was lost and what it took.

    endurance.py --program build/ci/apps/flextip [--seconds 3600] [--rate 120]
                 [--camera [WIDTH_PX]] [--controller rod-track] [--work FOLDER]

The tip follows the square of the page's picture round and round. Resident memory of both programs is
read every ten seconds; its slope is of the last nine tenths of the run. The session is replayed
afterwards. --work keeps the recording. The virtual laparoscope at 30 Hz needs a core for pictures of
640 pixels and about two for its own 1280.
"""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from live_run import LiveRun, round_and_round  # noqa: E402

SQUARE_S = 10.0  # once round at 2 mm/s
PERIOD_S = 10.0  # of looking at the memory


def resident_mb(process):
    """Returns the resident memory, None where the process has ended."""
    try:
        status = pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8")
    except OSError:
        return None
    for line in status.splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    return None


def slope_mb_per_hour(times, sizes):
    """Returns the least-squares slope over the last nine tenths."""
    first = len(times) // 10
    times, sizes = times[first:], sizes[first:]
    if len(times) < 3:
        return float("nan")
    return 3600 * statistics.linear_regression(times, sizes).slope


def watch(run, seconds):
    """Returns the memory of robot and control over the run, each as times (s) and sizes (MB)."""
    begin, memory = time.monotonic(), {"robot": ([], []), "control": ([], [])}
    while run.control.poll() is None and time.monotonic() - begin < seconds + 60:
        for name, process in zip(memory, run.programs):
            size = resident_mb(process)
            if size is not None:
                memory[name][0].append(time.monotonic() - begin)
                memory[name][1].append(size)
        time.sleep(PERIOD_S)
    run.wait(60)
    return memory


def endure(options, folder):
    loops = int(options.seconds / SQUARE_S) + 2
    waypoints = round_and_round(loops)
    print(f"load at the start: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    with LiveRun(options.program, folder, page=False, options=["--duration", options.seconds],
                 camera=options.camera is not None,
                 picture_width_px=options.camera, rate_hz=options.rate, waypoints=waypoints,
                 kind=options.controller) as run:
        memory = watch(run, options.seconds)
        print(run.said)
    summary = json.loads((run.recording / "summary.json").read_text(encoding="utf-8"))
    for name in ("work", "sample_to_command", "wake_late"):
        times = summary[name]
        print(f"{name:18} ms " + ", ".join(f"{key[:-2]} {1e3 * value:.3f}"
                                           for key, value in times.items() if key != "count"))
    print(f"missed {summary['missed_cycles']} of {summary['cycles']} cycles, "
          f"{summary['unsent_commands']} commands not sent, holds {summary['holds']}, "
          f"priority {summary['real_time_priority']}, memory locked {summary['locked_memory']}")
    print(f"warnings: {summary.get('warnings') or 'none'}; camera: {summary['camera']}; samples by "
          "stream: " + ", ".join(f"{name} {s['accepted']} of {s['arrived']}, {s['rate_hz']:.1f} Hz"
                                 for name, s in summary["streams"].items()))
    for name, (times, sizes) in memory.items():
        print(f"memory of {name}: {sizes[len(sizes) // 10]:.1f} MB after a tenth, {sizes[-1]:.1f} at "
              f"the end, {slope_mb_per_hour(times, sizes):+.2f} MB an hour")
    replayed = folder / "replayed"
    subprocess.run([options.program, "-q", "replay", run.recording, "-o", replayed], check=False)
    again = json.loads((replayed / "summary.json").read_text(encoding="utf-8"))
    print(f"replayed: {again['equal_cycles']} of {again['cycles']} cycles equal bit for bit")
    print(f"load at the end: {os.getloadavg()[0]:.1f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--seconds", type=int, default=3600)
    parser.add_argument("--rate", type=int, default=120)
    parser.add_argument("--camera", type=int, nargs="?", const=1280, metavar="WIDTH_PX")
    parser.add_argument("--controller", default="rod-track")
    parser.add_argument("--work", type=pathlib.Path)
    options = parser.parse_args()
    if options.work:
        options.work.mkdir(parents=True)
        endure(options, options.work)
        return
    with tempfile.TemporaryDirectory() as folder:
        endure(options, pathlib.Path(folder))


if __name__ == "__main__":
    main()
