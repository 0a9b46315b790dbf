#!/usr/bin/env python3
"""Compares a scenario through a socket with the same scenario in the simulator's own loop.

    through_socket.py --program build/ci/apps/flextip [--scenario press.yaml ...] [--seeds 5]
                      [--first-seed 11] [--start seen] [--out /tmp/live]

Each seed and controller runs twice: by `simulate` alone, and by `control` that steers
`simulate --serve --lockstep` in a process of its own. The true tip's distance from the path walked
so far is scored by the same lines for both. Also replays every session and counts the equal cycles.

The simulator's own loop has its path at the true tip's start. `--start true` gives the session that
path, so that only the loops differ; `--start seen` lets `control` begin where it sees the tip.
"""
import argparse
import csv
import json
import math
import pathlib
import re
import shutil
import statistics
import subprocess

import yaml

CONTROLLERS = ("straight-calculate", "straight-track", "flex-calculate", "flex-track",
               "rod-calculate", "rod-track")


def session_of(scenario, port, kind, start):
    """Returns the session on the robot of `scenario`; `start` (R) begins the path, None: as seen."""
    def device(name, **keys):
        return {"openigtlink": {"port": port, "device": name}, **keys}
    sensors, control = scenario["sensors"], scenario.get("control", {})
    noises = {name: {key: value for key, value in sensor.items() if key != "rate_hz"}
              for name, sensor in sensors.items()}
    sources = {"wrist0": device("PSM1/measured_cp", **noises["wrist"]),
               "vision0": device("vision0")}
    for name, stream in (("em0", "em0"), ("strain", "strain0")):
        if name in noises:
            sources[stream] = device(stream, **noises[name])
    path = dict(scenario["path"])
    path["frame"] = "start"
    if start is not None:
        path["frame"], path["start_m"] = "R", start
        path["waypoints"] = [{"to_m": [start[i] + way["to_m"][i] for i in range(3)]}
                             for way in path["waypoints"]]
    else:
        path["average_s"] = 1.0
    return {
        "format": "flextip-session", "version": 1,
        **{key: scenario[key] for key in ("instrument", "port", "gravity_m_s2")},
        "sources": sources,
        "robot": {"command": device("PSM1/servo_cp"), "state": device("PSM1/operating_state"),
                  "command_state": device("PSM1/state_command"), "lockstep": device("lockstep")},
        "controller": {"kind": kind, "rate_hz": 30, **control},
        "limits": {"max_step_m": 0.05, "max_speed_m_s": 0.9, "max_acceleration_m_s2": 90},
        "path": path,
    }


def rows(file):
    with open(file, newline="", encoding="utf-8") as text:
        reader = csv.reader(text)
        head = next(reader)
        head[0] = head[0].lstrip("#")
        return head, list(reader)


def distance(p, a, b):
    ab = [b[i] - a[i] for i in range(3)]
    length2 = sum(v * v for v in ab)
    u = max(0.0, min(1.0, sum((p[i] - a[i]) * ab[i] for i in range(3)) / length2))
    return math.dist(p, [a[i] + u * ab[i] for i in range(3)])


def truth_of(recording):
    _, data = rows(recording / "truth0/data.csv")
    return [(int(row[0]), [float(v) for v in row[1:4]]) for row in data]


def score(recording, scenario, begin_ns=None, end_ns=None):
    """Returns the largest and the RMS distance (mm) of the true tip from the path."""
    truth = truth_of(recording)
    start = truth[0][1]
    ways = [way["to_m"] for way in scenario["path"]["waypoints"]]
    corners = [start] + [[start[i] + way[i] for i in range(3)] for way in ways]
    lengths = [math.dist(corners[i], corners[i + 1]) for i in range(len(ways))]
    speed_m_s = scenario["path"].get("speed_m_s", 0.0)
    begin_ns = begin_ns or truth[0][0]
    seen = []
    for t_ns, p in truth:
        if t_ns < begin_ns or (end_ns and t_ns > end_ns):
            continue
        way, leg = (t_ns - begin_ns) * 1e-9 * speed_m_s, 0
        while leg < len(ways) - 1 and way >= lengths[leg]:
            way, leg = way - lengths[leg], leg + 1
        legs = range(max(0, leg - 1), leg + 1)
        seen.append(1e3 * min(distance(p, corners[i], corners[i + 1]) for i in legs))
    return max(seen), math.sqrt(statistics.fmean(v * v for v in seen))


def through_socket(program, file, scenario, kind, start, out):
    robot = subprocess.Popen([program, "simulate", file, "--serve", "0", "--lockstep", "-o",
                              out / "robot"], stdout=subprocess.PIPE, text=True)
    port = None
    while port is None:
        found = re.search(r"127\.0\.0\.1:(\d+)", robot.stdout.readline())
        port = found and int(found.group(1))
    (out / "session.yaml").write_text(yaml.safe_dump(session_of(scenario, port, kind, start)))
    subprocess.run([program, "-q", "control", out / "session.yaml", "-o", out / "run",
                    "--duration", "120"], check=True)
    robot.communicate()
    head, cycles = rows(out / "run/session0/cycles.csv")
    moving = [int(c[0]) for c in cycles if c[head.index("hold")] == "0"]
    subprocess.run([program, "-q", "replay", out / "run", "-o", out / "again"], check=False)
    again = json.loads((out / "again/summary.json").read_text())
    figures = score(out / "robot", scenario, moving[0], moving[-1])
    return figures, again["equal_cycles"], again["cycles"]


def deviation_of_ratio(all_seeds):
    """Returns the standard deviation of the ratio of the mean RMS, by their scatter over the seeds."""
    if len(all_seeds) < 2:
        return math.nan
    parts = [statistics.stdev(v[i] for v in all_seeds) /
             statistics.fmean(v[i] for v in all_seeds) for i in (1, 3)]
    ratio = statistics.fmean(v[3] for v in all_seeds) / statistics.fmean(v[1] for v in all_seeds)
    return ratio * math.hypot(*parts) / math.sqrt(len(all_seeds))


def compare(options, file):
    program = options.program.absolute()
    base = file.read_text(encoding="utf-8").replace("../", f"{file.absolute().parent}/../")
    figures = {kind: [] for kind in options.controllers}
    equal = cycles = 0
    for seed in range(options.first_seed, options.first_seed + options.seeds):
        shutil.rmtree(options.out, ignore_errors=True)
        options.out.mkdir(parents=True)
        seeded = options.out / "scenario.yaml"
        scenario = {**yaml.safe_load(base), "seed": seed, "controllers": options.controllers}
        seeded.write_text(yaml.safe_dump(scenario))
        subprocess.run([program, "-q", "simulate", seeded, "-o", options.out / "alone"],
                       check=True)
        for kind in options.controllers:
            out = options.out / kind
            out.mkdir()
            alone = options.out / "alone"
            if len(options.controllers) > 1:
                alone /= kind
            start = truth_of(alone)[0][1] if options.start == "true" else None
            socket, same, of = through_socket(program, seeded, scenario, kind, start, out)
            figures[kind].append((*score(alone, scenario), *socket))
            equal, cycles = equal + same, cycles + of
    shutil.rmtree(options.out)
    print(f"{file.stem}, {options.seeds} seeds; cycles replayed bit for bit: {equal} of {cycles}")
    print("controller           max mm alone, socket   RMS mm alone, socket   RMS ratio, its sd")
    for kind, all_seeds in figures.items():
        mean = [statistics.fmean(v[i] for v in all_seeds) for i in range(4)]
        print(f"{kind:20} {mean[0]:8.3f} {mean[2]:8.3f}     {mean[1]:8.3f} {mean[3]:8.3f} "
              f"{mean[3] / mean[1]:10.3f} {deviation_of_ratio(all_seeds):6.3f}")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--scenario", type=pathlib.Path, nargs="+",
                        default=[pathlib.Path("testdata/scenarios/press.yaml")])
    parser.add_argument("--controllers", nargs="+", choices=CONTROLLERS, default=list(CONTROLLERS))
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--first-seed", type=int, default=11)
    parser.add_argument("--start", choices=("seen", "true"), default="seen")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/flextip-live"))
    options = parser.parse_args()
    for file in options.scenario:
        compare(options, file)


if __name__ == "__main__":
    main()
