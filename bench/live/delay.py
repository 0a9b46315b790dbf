#!/usr/bin/env python3
"""Tables the press's deviation against the tip's latency.

    delay.py --program build/ci/apps/flextip [--seeds 3] [--first-seed 1] [--out /tmp/delay]

The simulated tip comes late by the effect camera_latency. "told": the controller knows it, by
`control: tip_latency_s`, and carries the tip on. "untold": it takes the tip as of now. Values are
the largest and the RMS deviation of the true tip from the path (mm), means over the seeds; behind
them the RMS over that of the same loop without latency.
"""
import argparse
import json
import pathlib
import re
import shutil
import statistics
import subprocess

KINDS = ("straight-track", "flex-track", "rod-track")
SENSORS = {"all sensors": "", "vision and gages": "em0|em1", "vision alone": "em0|em1|strain|load"}


def run(options, scenario, latency_s, told, rate_hz, seed):
    control = [f"rate_hz: {rate_hz}"]
    if told and latency_s:
        control.append(f"tip_latency_s: {{value: {latency_s}, sd: {options.sd}}}")
    text = re.sub(r"(?m)^seed:.*", f"seed: {seed}", scenario)
    text = re.sub(r"(?m)^controllers:.*", f"controllers: [{', '.join(KINDS)}]", text)
    text = re.sub(r"(?m)^control: \{(.*)\}", rf"control: {{\1, {', '.join(control)}}}", text)
    if latency_s:
        text += f"\neffects: {{camera_latency: {{delay_s: {latency_s}}}}}\n"
    shutil.rmtree(options.out, ignore_errors=True)
    options.out.mkdir(parents=True)
    file = options.out / "press.yaml"
    file.write_text(text)
    subprocess.run([options.program, "-q", "simulate", file, "-o", options.out / "run"], check=True)
    summary = json.loads((options.out / "run/summary.json").read_text())
    return {kind: (1e3 * c["max_deviation_m"], 1e3 * c["rms_deviation_m"])
            for kind, c in summary["controllers"].items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=pathlib.Path, required=True)
    parser.add_argument("--scenario", type=pathlib.Path, default="testdata/scenarios/press.yaml")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--sd", type=float, default=0.0, help="of the latency that is told (s)")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/flextip-delay"))
    options = parser.parse_args()
    options.program = options.program.absolute()
    folder = options.scenario.absolute().parent
    base = options.scenario.read_text().replace("../", f"{folder}/../")
    print("sensors, rate, latency ms, told | " + " | ".join(KINDS))
    for name, left_out in SENSORS.items():
        scenario = re.sub(rf"(?m)^  ({left_out}):.*\n", "", base) if left_out else base
        for rate_hz in (30, 120):
            first = None
            for latency_s, told in ((0.0, True), (0.033, True), (0.062, True), (0.1, True),
                                    (0.25, True), (0.062, False), (0.25, False)):
                seeds = range(options.first_seed, options.first_seed + options.seeds)
                runs = [run(options, scenario, latency_s, told, rate_hz, s) for s in seeds]
                mean = {k: [statistics.fmean(r[k][i] for r in runs) for i in (0, 1)]
                        for k in KINDS}
                first = first or mean
                cells = [f"{mean[k][0]:6.2f} {mean[k][1]:6.2f} {mean[k][1] / first[k][1]:5.2f}"
                         for k in KINDS]
                print(f"{name}, {rate_hz} Hz, {1e3 * latency_s:.0f}, {'told' if told else 'untold'} | "
                      + " | ".join(cells), flush=True)
    shutil.rmtree(options.out)


if __name__ == "__main__":
    main()
