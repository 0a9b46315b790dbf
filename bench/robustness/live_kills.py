#!/usr/bin/env python3
"""Kills a robot that is served, or the control that steers it, and looks at what both leave.

    live_kills.py --program build/ci/apps/flextip [--kills 60] [--seed 1] [--out /tmp/flextip-live]

Each turn starts `simulate --serve` and `control`, in lockstep or in real time, and kills one of the
two at a random moment (SIGKILL). The other must end by itself or by Ctrl-C, with a whole recording.
A killed control leaves nothing, or a recording that `check` opens and `replay` gives again bit for
bit; a killed robot leaves nothing.
"""
import argparse
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from live_run import LiveRun, end, round_and_round  # noqa: E402

LEAST_CYCLES = 3  # of a recording that says something


def opens(program, recording, out, verb):
    """Returns what the command says of the recording, or nothing where it has a result."""
    shutil.rmtree(out, ignore_errors=True)
    done = subprocess.run([program, verb, recording, "-o", out], check=False, capture_output=True,
                          text=True)
    if done.returncode == 0 or (verb == "check" and done.returncode == 1 and out.exists()):
        return ""
    return f"{verb}: {done.returncode} {done.stderr.strip()[-200:]!r}"


def cycles_of(recording):
    table = recording / "session0/cycles.csv"
    return len(table.read_text().splitlines()) - 1 if table.exists() else 0


class Trial:
    def __init__(self, options):
        self.options, self.random = options, random.Random(options.seed)
        self.wrong, self.short = [], 0

    def blame(self, turn, what):
        self.wrong.append(what)
        print(f"WRONG in turn {turn}: {what}", flush=True)

    def look(self, turn, recording, name):
        for verb in ("check", "replay") if name == "control" else ("check",):
            says = opens(self.options.program, recording, self.options.out / "looked", verb)
            if says and "has no command to replay" not in says:  # it had only watched
                self.blame(turn, f"{name}'s recording ({cycles_of(recording)} cycles): {says}")

    def turn(self, turn, kills_control, lockstep):
        out = self.options.out
        shutil.rmtree(out, ignore_errors=True)
        out.mkdir(parents=True)
        with LiveRun(self.options.program, out, page=False, options=["-q"], served=out / "served",
                     camera=False, lockstep=lockstep, rate_hz=30 if lockstep else 120,
                     waypoints=round_and_round(50)) as run:
            time.sleep(self.random.uniform(0.0, self.options.seconds))
            victim, other = (run.control, run.robot) if kills_control else (run.robot, run.control)
            if victim.poll() is not None:
                self.blame(turn, f"{victim.args[1]} had ended: {victim.returncode}")
            victim.send_signal(signal.SIGKILL)
            victim.communicate()
            time.sleep(0.5)  # it may notice by itself
            code = end(other)
        young = code == -signal.SIGINT and cycles_of(run.recording) == 0  # it just began
        if code not in (0, 1, 2) and not young:
            self.blame(turn, f"{other.args[1]} ended by {code}")
        if kills_control:
            self.after_control(turn, run, code)
        else:
            self.after_robot(turn, run)

    def after_control(self, turn, run, code):
        if code != 0 or not (run.served / "summary.json").exists():
            if cycles_of(run.recording) > LEAST_CYCLES:
                self.blame(turn, f"the robot ended by {code} and left no recording")
        else:
            self.look(turn, run.served, "robot")
        if cycles_of(run.recording) > LEAST_CYCLES:
            self.look(turn, run.recording, "control")
        else:
            self.short += 1

    def after_robot(self, turn, run):
        if run.served.exists():
            self.blame(turn, "a killed robot left a recording")
        if cycles_of(run.recording) > LEAST_CYCLES:
            self.look(turn, run.recording, "control")
        else:
            self.short += 1


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--kills", type=int, default=60)
    parser.add_argument("--seconds", type=float, default=3.0, help="of a run, at most")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/flextip-live"))
    options = parser.parse_args()
    options.program = str(pathlib.Path(options.program).resolve())
    trial = Trial(options)
    for turn in range(options.kills):
        trial.turn(turn, kills_control=turn % 2 == 0, lockstep=turn % 4 < 2)
    print(f"{options.kills} kills; control had fewer than {LEAST_CYCLES + 1} cycles in "
          f"{trial.short}; wrong: {len(trial.wrong)}")
    shutil.rmtree(options.out, ignore_errors=True)
    return 1 if trial.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
