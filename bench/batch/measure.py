#!/usr/bin/env python3
"""Times flextip batch beside GNU parallel, which runs the program once an item.

    measure.py --program build/ci/apps/flextip [--command estimate] [--items 200]
               [--input testdata/recordings/sample_0] [--out /tmp/batch]

Prints a row a way of running: seconds, items a second, and against parallel with as many jobs.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import time


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--command", default="estimate")
    parser.add_argument("--input", default="testdata/recordings/sample_0")
    parser.add_argument("--items", type=int, default=200)
    parser.add_argument("--out", type=pathlib.Path, default="/tmp/flextip-batch-bench")
    options = parser.parse_args()
    program, source = os.path.abspath(options.program), os.path.abspath(options.input)
    shutil.rmtree(options.out, ignore_errors=True)
    options.out.mkdir(parents=True)
    items = options.out / "items.txt"
    items.write_text("".join(f"{source} name=i{i}\n" for i in range(options.items)))
    batch = [program, "-q", "batch", options.command, str(items)]
    mpirun = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n"]
    ways = []
    for jobs in (1, 2):
        if shutil.which("parallel"):
            alone = f"{program} -q {options.command} {source} -o {options.out}/p{jobs}/{{}}"
            ways.append((f"parallel, {jobs}", jobs,
                         ["parallel", "-j", str(jobs), alone, ":::",
                          *map(str, range(options.items))]))
        ways.append((f"batch, {jobs}", jobs,
                     [*batch, "-o", str(options.out / f"b{jobs}"), "--jobs", str(jobs)]))
    if shutil.which("mpirun"):
        for ranks in (2, 3):
            ways.append((f"mpirun, {ranks} ranks", 2,
                         [*mpirun, str(ranks), *batch, "-o", str(options.out / f"m{ranks}")]))
    parallel = {}
    print(f"{options.items} x {options.command}")
    for name, jobs, command in ways:
        begin = time.monotonic()
        code = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
                              check=False).returncode
        seconds = time.monotonic() - begin
        parallel.setdefault(jobs, seconds)
        print(f"{name:18} {seconds:8.2f} s {options.items / seconds:8.2f} items/s "
              f"{parallel[jobs] / seconds:5.2f} x as fast, exit {code}", flush=True)
    shutil.rmtree(options.out)


if __name__ == "__main__":
    main()
