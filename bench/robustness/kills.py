#!/usr/bin/env python3
"""Disturbs every command, and looks that what looks whole is whole.

    kills.py --program build/ci/apps/flextip [--kills 1000] [--seed 1] [--out /tmp/flextip-kills]

Each command runs undisturbed first. Then it is killed at random moments; a result must be absent or
as the undisturbed one: the same files. Further: the disk is full at a random size (ulimit -f), the
folder is write-protected (left out for root), two runs go into one folder at once, with and without
--force, and the input changes while it is read.
"""
import argparse
import math
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import time

from commands import Commands


class Trial:
    def __init__(self, options):
        shutil.rmtree(options.out, ignore_errors=True)
        self.place = options.out
        self.random = random.Random(options.seed)
        root = pathlib.Path(__file__).resolve().parents[2]
        self.commands = Commands(options.program, root, options.out)
        self.wrong = []

    def start(self, name, out, force=False, **more):
        return subprocess.Popen(self.commands.words(name, out, force), text=True,
                                stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, **more)

    def fresh(self):
        shutil.rmtree(self.place / "work", ignore_errors=True)
        (self.place / "work").mkdir()
        return self.place / "work" / "out"

    def blame(self, name, what):
        self.wrong.append(f"{name}: {what}")
        print("WRONG", self.wrong[-1], flush=True)

    def same_names(self, name, out, what, may_lack=True):
        found = self.commands.files(name, out)
        if found is None:
            if not may_lack:
                self.blame(name, f"{what}: no result")
            return
        whole = self.whole
        if name == "batch" and "summary.json" not in found:
            return  # grows at its place, and says so by having no summary yet
        if set(found) != set(whole):
            self.blame(name, f"{what}: {sorted(set(found) ^ set(whole))[:5]}")
        empty = [f for f, size in found.items() if size == 0 and whole.get(f, 0) > 0]
        if empty:
            self.blame(name, f"{what}: empty {empty[:5]}")

    def undisturbed(self, name):
        out = self.fresh()
        begin = time.monotonic()
        process = self.start(name, out)
        _, err = process.communicate()
        self.seconds = time.monotonic() - begin
        self.done = process.returncode  # 1 where the verdict is that something is wrong
        self.whole = self.commands.files(name, out)
        if self.whole is None:
            self.blame(name, f"does not run: {err.strip()[:200]}")
            return False
        return True

    def kill(self, name, count):
        """Returns how many runs were killed, and how many ended before."""
        killed, late = 0, 0
        while killed < count and late < count:
            out = self.fresh()
            force = (killed + late) % 3 == 2
            if force:
                self.start(name, out).communicate()
            begin = time.monotonic()
            process = self.start(name, out, force)
            try:
                process.communicate(timeout=self.random.uniform(0.0, self.seconds))
                # Faster than before: what a run takes hangs on the machine's other work.
                late += 1
                self.seconds = 0.5 * (self.seconds + time.monotonic() - begin)
            except subprocess.TimeoutExpired:
                killed += 1
                process.send_signal(signal.SIGKILL)
                process.communicate()
            self.same_names(name, out, "killed", may_lack=not force or name == "batch")
        return killed, late

    def full_disk(self, name, count):
        largest = max(self.whole.values())
        for _ in range(count):
            out = self.fresh()
            limit = self.random.randint(0, max(largest - 1, 1))

            def become(limit=limit):
                signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # as a full disk: a write fails
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
            process = self.start(name, out, preexec_fn=become)
            _, err = process.communicate()
            if process.returncode == 0:
                self.blame(name, f"full disk at {limit} bytes: says that it is done")
            elif process.returncode not in (1, 2):
                self.blame(name, f"full disk at {limit} bytes: ended by {process.returncode}")
            elif "cannot be written" not in err and "cannot make" not in err:
                self.blame(name, f"full disk at {limit} bytes: says {err.strip()[-200:]!r}")
            if name != "batch":
                if out.exists():
                    self.blame(name, f"full disk at {limit} bytes: left a result")
                left = [p.name for p in out.parent.iterdir()]
                if left:
                    self.blame(name, f"full disk at {limit} bytes: left {left}")

    def protected(self, name):
        if os.geteuid() == 0:
            return
        out = self.fresh()
        out.parent.chmod(0o500)
        process = self.start(name, out)
        _, err = process.communicate()
        out.parent.chmod(0o700)
        if process.returncode not in (1, 2) or not err.startswith("flextip: "):
            self.blame(name, f"write-protected: {process.returncode} {err.strip()[-200:]!r}")

    def two_at_once(self, name, count):
        for turn in range(count):
            out = self.fresh()
            force = turn % 2 == 1 and name != "batch"  # which goes on with what is there
            if force:
                self.start(name, out).communicate()
            first = self.start(name, out, force)
            time.sleep(self.random.uniform(0.0, 0.3 * self.seconds))
            second = self.start(name, out, force)
            ends = []
            for process in (first, second):
                _, err = process.communicate()
                ends.append(process.returncode)
                if process.returncode not in (0, 1, 2):
                    self.blame(name, f"two at once: {process.returncode} {err.strip()[-200:]!r}")
            if self.done not in ends:
                self.blame(name, f"two at once: neither came to its end {ends}")
            self.same_names(name, out, "two at once", may_lack=False)
            left = [p.name for p in out.parent.iterdir() if p != out]
            if left:
                self.blame(name, f"two at once: left {left}")

    def changing_input(self, name, count):
        """A table of the input is cut, grows or is exchanged while the command runs."""
        files = self.commands.tables(name)
        if not files:
            return
        for _ in range(count):
            out = self.fresh()
            file = self.random.choice(files)
            whole = file.read_bytes()
            process = self.start(name, out)
            time.sleep(self.random.uniform(0.0, 0.5 * self.seconds))
            way = self.random.choice(("cut", "grow", "exchange"))
            if way == "cut":
                os.truncate(file, self.random.randint(0, len(whole)))
            elif way == "grow":
                with open(file, "ab") as more:
                    more.write(b"1,2,3\n")
            else:
                file.unlink()
                file.write_bytes(whole[:len(whole) // 2])
            _, err = process.communicate()
            file.write_bytes(whole)
            if process.returncode not in (0, 1, 2) or "not foreseen" in err:
                self.blame(name, f"input {way}: {process.returncode} {err.strip()[-200:]!r}")
            if process.returncode == 0 and not out.exists():
                self.blame(name, f"input {way}: no result")
            judged = name in ("check", "align", "replay")  # a result may be that something is wrong
            if process.returncode != 0 and out.exists() and name != "batch" and not judged:
                self.blame(name, f"input {way}: failed and left a result")


def allot(kills, seconds):
    """Returns how many kills each command gets: the fewer the longer it runs, twelve at least."""
    whole = sum(1.0 / (1.0 + s) for s in seconds.values())
    return {n: max(12, math.ceil(kills / (1.0 + s) / whole)) for n, s in seconds.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--kills", type=int, default=1000, help="over all commands")
    parser.add_argument("--others", type=int, default=4, help="of each other kind, each command")
    parser.add_argument("--only", help="one command")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/flextip-kills"))
    options = parser.parse_args()
    trial = Trial(options)
    names = [options.only] if options.only else list(trial.commands.lines)
    shares = allot(options.kills, {n: trial.seconds for n in names if trial.undisturbed(n)})
    kills, late = 0, 0
    for name, each in shares.items():
        if not trial.undisturbed(name):
            continue
        killed, came_late = trial.kill(name, each)
        kills, late = kills + killed, late + came_late
        trial.full_disk(name, options.others)
        trial.protected(name)
        trial.two_at_once(name, options.others)
        trial.changing_input(name, options.others)
        print(f"{name:18} {trial.seconds:6.2f} s, {killed} kills; {came_late} ended before",
              flush=True)
    print(f"{kills} kills; {late} ended before; wrong: {len(trial.wrong)}")
    shutil.rmtree(options.out, ignore_errors=True)
    return 1 if trial.wrong else 0


if __name__ == "__main__":
    sys.exit(main())
