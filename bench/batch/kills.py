#!/usr/bin/env python3
"""Kills flextip batch at random moments and looks whether anything is lost or done twice.

    kills.py --program build/ci/apps/flextip [--kills 100] [--seed 1] [--out /tmp/batch-kills]

Each turn goes on with --resume and ends by a blow: SIGKILL to the program, to the process that starts
its items, to mpirun, to one of its ranks; or the disk is full (a small file system of its own; left
out where none can be mounted). When all items are done, the table, the items and the records are
compared with those of a run that nobody disturbed, and a new folder is begun.
"""
import argparse
import csv
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

BLOWS = ("program", "starter", "mpirun", "rank", "disk")
TIMES = ("seconds", "frames_per_second", "host")


def below(pid):
    """Returns (pid, name) of all processes below one, the nearest first."""
    found, parents = [], [pid]
    processes = []
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            text = stat.read_text()
        except OSError:
            continue
        name = text[text.index("(") + 1:text.rindex(")")]
        state, parent = text[text.rindex(")") + 2:].split()[:2]
        if state != "Z":
            processes.append((int(stat.parent.name), int(parent), name))
    while parents:
        parent = parents.pop(0)
        for process, above, name in processes:
            if above == parent:
                found.append((process, name))
                parents.append(process)
    return found


def table_of(out):
    """Returns the rows of the table without what the moment and the machine decide."""
    with open(out / "table.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return [{k: v for k, v in row.items() if k not in TIMES} for row in rows]


def files_of(out):
    return {str(p.relative_to(out)): p.read_bytes() for p in sorted((out / "items").rglob("*"))
            if p.is_file()}


class Trial:
    def __init__(self, options):
        self.program = os.path.abspath(options.program)
        self.random = random.Random(options.seed)
        self.place = options.out
        self.disk = options.out / "disk"
        shutil.rmtree(self.place, ignore_errors=True)
        self.disk.mkdir(parents=True)
        self.mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64m", "tmpfs", self.disk],
                                      check=False, capture_output=True).returncode == 0
        self.blows = [b for b in BLOWS if b != "disk" or self.mounted]
        if not shutil.which("mpirun"):
            self.blows = [b for b in self.blows if b not in ("mpirun", "rank")]
        recordings = sorted(pathlib.Path("testdata/recordings").absolute().glob("sample_*"))
        lines = ["absent"] + [f"{r} name=item{i}-{k}" for i, r in enumerate(recordings)
                              for k in range(5)]
        self.items = len(lines)
        self.list = self.place / "list.txt"
        self.list.write_text("\n".join(lines) + "\n")
        self.counts = dict.fromkeys(self.blows, 0)
        self.late = 0

    def line(self, out, ranks):
        line = [self.program, "batch", "check", str(self.list), "-o", str(out), "--resume"]
        if not ranks:
            return line + ["--jobs", "2"]
        return ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n", "3", *line]

    def run(self, out, ranks=False):
        return subprocess.run(self.line(out, ranks), check=False, capture_output=True)

    def target(self, blow, process):
        """Returns whom to kill, None where there is nobody yet."""
        if blow in ("program", "mpirun"):
            return process
        wanted = "flextip-items" if blow == "starter" else "flextip"
        found = [p for p, name in below(process) if name.startswith(wanted)]
        if blow == "rank":
            found = [p for p, name in below(process) if name not in ("flextip-items", "flextip-item")]
        return self.random.choice(found) if found else None

    def strike(self, out):
        blow = self.random.choice(self.blows)
        ranks = blow in ("mpirun", "rank")
        filler = self.disk / "filler"
        process = subprocess.Popen(self.line(out, ranks), stdout=subprocess.DEVNULL,
                                   stderr=subprocess.DEVNULL)
        time.sleep(self.random.uniform(0.0, 2.5 if ranks else 1.2))
        if process.poll() is not None:
            self.late += 1
            return
        if blow == "disk":
            with open(filler, "wb", buffering=0) as file:
                try:
                    while file.write(b"x" * 65536):
                        pass
                except OSError:
                    pass
        else:
            target = self.target(blow, process.pid)
            if target:
                try:
                    os.kill(target, signal.SIGKILL)
                except ProcessLookupError:
                    target = None
            if not target:
                self.late += 1
                blow = None
        process.wait(timeout=120)
        filler.unlink(missing_ok=True)
        if blow:
            self.counts[blow] += 1

    def compare(self, out, whole):
        """Returns what is not as in the undisturbed run."""
        wrong = []
        if table_of(out) != table_of(whole):
            wrong.append("table")
        if files_of(out) != files_of(whole):
            wrong.append("items")
        names = [line.split("\t")[0] for line in
                 (out / "records.tsv").read_text(encoding="utf-8").splitlines()]
        if len(names) != self.items or len(set(names)) != self.items:
            wrong.append(f"{len(names)} records of {len(set(names))} items")
        return wrong

    def close(self):
        if self.mounted:
            subprocess.run(["umount", self.disk], check=False)
        shutil.rmtree(self.place, ignore_errors=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--kills", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("/tmp/flextip-batch-kills"))
    options = parser.parse_args()
    trial = Trial(options)
    whole, out, wholes, wrong = trial.place / "whole", trial.disk / "out", 0, []
    try:
        trial.run(whole)
        while sum(trial.counts.values()) < options.kills:
            trial.strike(out)
            records = out / "records.tsv"
            done = len(records.read_text(encoding="utf-8").splitlines()) if records.exists() else 0
            last = sum(trial.counts.values()) >= options.kills
            if done < trial.items and not last:
                continue
            trial.run(out, ranks=trial.random.random() < 0.5 and "rank" in trial.blows)
            wholes += 1
            wrong += trial.compare(out, whole)
            shutil.rmtree(out)
    finally:
        trial.close()
    print(f"{sum(trial.counts.values())} blows: "
          + ", ".join(f"{blow} {n}" for blow, n in trial.counts.items())
          + f"; {trial.late} came too late or too early")
    print(f"{wholes} batches of {trial.items} items came to their end; not as undisturbed: {wrong}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
