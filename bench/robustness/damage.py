#!/usr/bin/env python3
"""Runs commands on damaged inputs, and looks how they end.

    damage.py --program build/ci/apps/flextip [--inputs 2000] [--seed 1] [--seconds 60]

Each input is a good one with one damage: a number that is finite and absurd, a byte, a torn end, a
line twice or missing, control characters, or a pipe, a device or a folder in the place of a file. A
command must end within the time and 1.5 GB: by 0, or by 1 or 2 with one line that says what is
wrong, without control characters and without the words of other libraries.
"""
import argparse
import collections
import os
import pathlib
import random
import re
import resource
import shutil
import subprocess
import sys

from commands import Commands

NUMBER = re.compile(rb"(?<![\w.])-?\d+\.?\d*(?:[eE][-+]?\d+)?(?![\w.])")
ABSURD = [b"1e150", b"-1e150", b"1e-150", b"1e9", b"-1e9", b"1e-9", b"0", b"-1", b"1e300", b"1e12",
          b"99999999999", b"1e5", b"-1e5", b"1e-5", b"4000000000000000001", b"nan", b"inf"]
FOREIGN = re.compile(r"OpenCV\(|json\.exception|yaml-cpp|std::|bad_alloc|not foreseen|terminate|"
                     r"Assertion|Sanitizer|holds a NaN")
GB = 2 ** 30


def damaged(text, rng):
    way = rng.randrange(8)
    if way < 4:
        numbers = list(NUMBER.finditer(text))
        if numbers:
            # A table's first rows are as likely as its last; settings more likely than either.
            number = rng.choice(numbers[:30] if rng.random() < 0.5 else numbers)
            value = rng.choice(ABSURD)
            return text[:number.start()] + value + text[number.end():], value.decode()
    at = rng.randrange(len(text)) if text else 0
    if way == 4:
        return text[:at], "cut"
    if way == 5:
        return text[:at] + rng.choice([b"\x1b[2J", b"\x07", b"\x00", b"\xc2\x9b", b"\xff", b"\r"]
                                      ) + text[at:], "control"
    lines = text.splitlines(keepends=True)
    if way == 6 and lines:
        i = rng.randrange(len(lines))
        return b"".join(lines[:i] + lines[i + 1:]), "line missing"
    return text[:at] + bytes([rng.randrange(256)]) + text[at + 1:], "byte"


def odd(file, rng):
    kind = rng.choice(["pipe", "device", "folder", "empty"])
    file.unlink()
    if kind == "pipe":
        os.mkfifo(file)
    elif kind == "device":
        file.symlink_to(rng.choice(["/dev/zero", "/dev/null"]))
    elif kind == "folder":
        file.mkdir()
    else:
        file.touch()
    return kind


class Campaign:
    def __init__(self, options):
        shutil.rmtree(options.out, ignore_errors=True)
        self.place, self.seconds = options.out, options.seconds
        self.rng = random.Random(options.seed)
        root = pathlib.Path(__file__).resolve().parents[2]
        self.commands = Commands(options.program, root, options.out)
        data = root / "testdata"
        sample = data / "recordings/sample_0"
        (options.out / "map").mkdir()
        self.cases = []
        for name in ("estimate", "check", "align"):
            self.cases.append((name, sample, lambda f, n=name: [n, f]))
        inputs = self.commands.inputs
        short, arm = inputs / "short", inputs / "arm"
        self.cases.append(("diagnose", short, lambda f: ["diagnose", f]))
        self.cases.append(("diagnose several", inputs / "later", lambda f: [
            "diagnose", short, f, "--no-closed-loop"]))
        self.cases.append(("diagnose motion", short, lambda f: [
            "diagnose", f, "--no-closed-loop", "--plan-motion", "--plan-seconds", "2"]))
        for _ in range(2):  # their files are many
            self.cases.append(("diagnose arm", arm, lambda f: ["diagnose", f]))
        self.cases.append(("predict", short, lambda f: ["predict", f, "--model",
                                                        inputs / "found/model.yaml"]))
        for recording, found in ((short, "found"), (arm, "arm_found")):
            self.cases.append(("predict by", inputs / found / "model.yaml",
                               lambda f, r=recording: ["predict", r, "--model", f]))
        self.cases.append(("effect new", inputs / "term.yaml", lambda f: ["effect", "new", f]))
        self.cases.append(("replay", self.commands.simulated, lambda f: ["replay", f]))
        self.cases.append(("track", data / "recordings/rendered", lambda f: ["track", f]))
        self.cases.append(("export csv", sample, lambda f: ["export", "csv", f]))
        for scenario in ("press", "chapter4_up", "direction"):
            self.cases.append(("simulate", data / f"scenarios/{scenario}.yaml",
                               lambda f: ["simulate", f]))
        for name in ("thesis", "tolerance"):
            self.cases.append(("map", data / f"maps/{name}.yaml", lambda f: ["map", f]))
        self.cases.append(("corners", inputs / "corners.csv",
                           lambda f: ["calibrate", "camera", "--corners", f, "--board",
                                      "chessboard:9x6:0.025"]))
        self.cases.append(("import", inputs / "robot.csv",
                           lambda f: ["import", "csv", f, "--length", "0.6", "--diameter", "2.4mm",
                                      "--stiffness", "0.3", "--port", "0.28,0,0", "--set",
                                      "wrist0.orientation_noise_rad=0.001"]))
        self.ends = collections.Counter()
        self.wrong = []

    def input(self, source):
        target = self.place / "in"
        shutil.rmtree(target, ignore_errors=True)
        target.unlink(missing_ok=True)
        if source.is_dir():
            shutil.copytree(source, target)
            files = sorted(p for p in target.rglob("*") if p.suffix in (".yaml", ".csv"))
            return target, self.rng.choice(files)
        target.mkdir()
        copy = target / source.name
        shutil.copy(source, copy)
        return copy, copy

    def turn(self):
        name, source, line = self.rng.choice(self.cases)
        target, file = self.input(source)
        if self.rng.random() < 0.04:
            what = odd(file, self.rng)
        else:
            text, what = damaged(file.read_bytes(), self.rng)
            file.write_bytes(text)
        out = self.place / "out"
        shutil.rmtree(out, ignore_errors=True)
        if out.is_file():
            out.unlink()
        words = [self.commands.program, *map(str, line(target)), "-o", str(out), "--quiet"]

        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (3 * GB // 2, 3 * GB // 2))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        try:
            end = subprocess.run(words, check=False, capture_output=True, timeout=self.seconds,
                                 preexec_fn=limit)
            problem = self.judge(end)
        except subprocess.TimeoutExpired:
            problem = f"took more than {self.seconds} s"
        if problem:
            kept = self.place / "wrong" / str(len(self.wrong))
            shutil.copytree(self.place / "in", kept, symlinks=True,
                            ignore=lambda folder, names: [n for n in names if n.endswith(".png")])
            self.wrong.append(f"{name}: {file.name}: {what}: {problem}")
            print("WRONG", len(self.wrong) - 1, self.wrong[-1], flush=True)

    def judge(self, end):
        err = end.stderr.decode(errors="replace")
        self.ends[end.returncode] += 1
        if end.returncode not in (0, 1, 2):
            return f"ended by {end.returncode}: {err[-300:]!r}"
        if any(ord(c) < 0x20 and c != "\n" or 0x7f <= ord(c) < 0xa0 for c in err):
            return f"control characters: {err[-300:]!r}"
        if FOREIGN.search(err):
            return f"foreign words: {err[-300:]!r}"
        if end.returncode != 0:
            last = err.strip().splitlines()[-1:] or [""]
            if not last[0].startswith("flextip: "):
                return f"no line that says what is wrong: {err[-300:]!r}"
        return ""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--inputs", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/flextip-damage"))
    options = parser.parse_args()
    campaign = Campaign(options)
    for _ in range(options.inputs):
        campaign.turn()
    print(f"{options.inputs} damaged inputs, ends {dict(campaign.ends)}; "
          f"wrong: {len(campaign.wrong)}")
    return 1 if campaign.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
