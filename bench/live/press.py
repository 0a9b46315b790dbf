#!/usr/bin/env python3
"""Compares the press through a socket with the same press in the simulator's own loop.

    press.py --program build/ci/apps/flextip [--seeds 5] [--first-seed 11] [--out /tmp/live]

Each seed and controller runs twice: by `simulate` alone, and by `control` that steers
`simulate --serve --lockstep` in a process of its own. The true tip's distance from the path walked so
far is scored by the same lines for both. Also replays every session and counts the equal cycles.
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

CONTROLLERS = ("straight-calculate", "straight-track", "flex-calculate", "flex-track",
               "rod-calculate", "rod-track")
WAY_M = ([0, 0, -0.010], [0, 0.006, -0.010], [0, 0.006, 0.0])  # as in press.yaml
SPEED_M_S = 0.015

SESSION = """format: flextip-session
version: 1
instrument: {{length_m: 0.6, outer_diameter_m: 0.00238, bending_stiffness_Nm2: 0.304}}
port: {{position_m: [0.0, 0.0, 0.17]}}
gravity_m_s2: [0.0, 0.0, -9.81]
sources:
  wrist0: {{{peer}PSM1/measured_cp}}, position_noise_m: 0.00005, orientation_noise_rad: 0.0003}}
  em0: {{{peer}em0}}, distance_from_tip_m: 0.02, position_noise_m: 0.00013,
        orientation_noise_rad: 0.00056}}
  strain0: {{{peer}strain0}}, stations_from_wrist_m: [0.15, 0.5], moment_noise_Nm: 0.0008}}
  vision0: {{{peer}vision0}}}}
robot:
  command: {{{peer}PSM1/servo_cp}}}}
  state: {{{peer}PSM1/operating_state}}}}
  command_state: {{{peer}PSM1/state_command}}}}
  lockstep: {{{peer}lockstep}}}}
controller: {{kind: {kind}, rate_hz: 30, max_step_m: 0.02, beam_load_law: tip_force}}
limits: {{max_step_m: 0.02, max_speed_m_s: 0.3, max_acceleration_m_s2: 100}}
path: {{frame: start, average_s: 1.0, speed_m_s: 0.015, settle_s: 0.3,
       waypoints: [{way}]}}
"""


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


def score(recording, begin_ns=None, end_ns=None):
    """Returns the largest and the RMS distance (mm) of the true tip from the path."""
    _, data = rows(recording / "truth0/data.csv")
    truth = [(int(row[0]), [float(v) for v in row[1:4]]) for row in data]
    start = truth[0][1]
    corners = [start] + [[start[i] + way[i] for i in range(3)] for way in WAY_M]
    lengths = [math.dist(corners[i], corners[i + 1]) for i in range(3)]
    begin_ns = begin_ns or truth[0][0]
    seen = []
    for t_ns, p in truth:
        if t_ns < begin_ns or (end_ns and t_ns > end_ns):
            continue
        way, leg = (t_ns - begin_ns) * 1e-9 * SPEED_M_S, 0
        while leg < 2 and way >= lengths[leg]:
            way, leg = way - lengths[leg], leg + 1
        legs = range(max(0, leg - 1), leg + 1)
        seen.append(1e3 * min(distance(p, corners[i], corners[i + 1]) for i in legs))
    return max(seen), math.sqrt(statistics.fmean(v * v for v in seen))


def through_socket(program, scenario, kind, out):
    robot = subprocess.Popen([program, "simulate", scenario, "--serve", "0", "--lockstep", "-o",
                              out / "robot"], stdout=subprocess.PIPE, text=True)
    port = None
    while port is None:
        found = re.search(r"127\.0\.0\.1:(\d+)", robot.stdout.readline())
        port = found and found.group(1)
    way = ", ".join(f"{{to_m: {list(w)}}}" for w in WAY_M)
    peer = f"openigtlink: {{port: {port}, device: "
    (out / "session.yaml").write_text(SESSION.format(peer=peer, kind=kind, way=way))
    subprocess.run([program, "-q", "control", out / "session.yaml", "-o", out / "run",
                    "--duration", "120"], check=True)
    robot.communicate()
    head, cycles = rows(out / "run/session0/cycles.csv")
    moving = [int(c[0]) for c in cycles if c[head.index("hold")] == "0"]
    subprocess.run([program, "-q", "replay", out / "run", "-o", out / "again"], check=False)
    again = json.loads((out / "again/summary.json").read_text())
    return score(out / "robot", moving[0], moving[-1]), again["equal_cycles"], again["cycles"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--scenario", type=pathlib.Path, default="testdata/scenarios/press.yaml")
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--first-seed", type=int, default=11)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/flextip-live"))
    options = parser.parse_args()
    program = options.program.absolute()
    base = options.scenario.read_text().replace("../", f"{options.scenario.absolute().parent}/../")
    figures = {kind: [] for kind in CONTROLLERS}
    equal = cycles = 0
    for seed in range(options.first_seed, options.first_seed + options.seeds):
        shutil.rmtree(options.out, ignore_errors=True)
        options.out.mkdir(parents=True)
        scenario = options.out / "press.yaml"
        scenario.write_text(re.sub(r"(?m)^seed:.*", f"seed: {seed}", base))
        subprocess.run([program, "-q", "simulate", scenario, "-o", options.out / "alone"],
                       check=True)
        for kind in CONTROLLERS:
            out = options.out / kind
            out.mkdir()
            socket, same, of = through_socket(program, scenario, kind, out)
            figures[kind].append((*score(options.out / "alone" / kind), *socket))
            equal, cycles = equal + same, cycles + of
    shutil.rmtree(options.out)
    print(f"{options.seeds} seeds; cycles replayed bit for bit: {equal} of {cycles}")
    print("controller           max mm alone, socket   RMS mm alone, socket   RMS ratio")
    for kind, all_seeds in figures.items():
        mean = [statistics.fmean(v[i] for v in all_seeds) for i in range(4)]
        print(f"{kind:20} {mean[0]:8.3f} {mean[2]:8.3f}     {mean[1]:8.3f} {mean[3]:8.3f} "
              f"{mean[3] / mean[1]:10.3f}")


if __name__ == "__main__":
    main()
