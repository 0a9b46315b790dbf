#!/usr/bin/env python3
"""Times flextip batch beside GNU parallel, which runs the program once an item.

    measure.py --program build/ci/apps/flextip [--command estimate] [--items 200]
               [--input testdata/recordings/sample_0] [--rounds 4] [--out /tmp/batch]

Every way of running does its share of the items in each round, so that a machine that becomes slower
does so for all of them. Prints a row a way: seconds, items a second, and how many times as fast as
`parallel` with as many jobs. "two processes" is what the cores give: two shells, each bound to a core
of its own, that run the program item after item.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import time

MPIRUN = ["mpirun", "--allow-run-as-root", "--oversubscribe", "-n"]


def ways_of(program, command, source, count, out):
    """Returns (name, jobs, command line) of each way to run `count` items."""
    items = out / "items.txt"
    items.write_text("".join(f"{source} name=i{i}\n" for i in range(count)))
    alone = f"{program} -q {command} {source} -o"
    batch = [program, "-q", "batch", *command.split(), str(items), "-o"]
    half = f"for i in $(seq {count // 2}); do {alone} {out}/two$1/$i; done"
    ways = []
    for jobs in (1, 2):
        ways.append((f"parallel -j {jobs}", jobs,
                     ["parallel", "-j", str(jobs), f"{alone} {out}/p{jobs}/{{}}", ":::",
                      *map(str, range(count))]))
        ways.append((f"batch --jobs {jobs}", jobs, [*batch, f"{out}/b{jobs}", "--jobs", str(jobs)]))
    ways.append(("two processes", 2,
                 ["bash", "-c", f"run() {{ {half}; }}; export -f run; "
                  "taskset -c 0 bash -c 'run 0' & taskset -c 1 bash -c 'run 1'; wait"]))
    for ranks in (2, 3):
        ways.append((f"mpirun -n {ranks}", 2, [*MPIRUN, str(ranks), *batch, f"{out}/m{ranks}"]))
    return ways


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--command", default="estimate")
    parser.add_argument("--input", default="testdata/recordings/sample_0")
    parser.add_argument("--items", type=int, default=200)
    parser.add_argument("--rounds", type=int, default=4)
    parser.add_argument("--out", type=pathlib.Path, default="/tmp/flextip-batch-bench")
    options = parser.parse_args()
    program, source = os.path.abspath(options.program), os.path.abspath(options.input)
    share = options.items // options.rounds
    seconds = {}
    for _ in range(options.rounds):
        shutil.rmtree(options.out, ignore_errors=True)
        options.out.mkdir(parents=True)
        for name, jobs, line in ways_of(program, options.command, source, share, options.out):
            begin = time.monotonic()
            done = subprocess.run(line, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                  check=False)
            if done.returncode != 0:
                print(f"{name}: exit {done.returncode}: {done.stderr.decode()[-300:]}")
            seconds[name] = (jobs, seconds.get(name, (jobs, 0.0))[1] + time.monotonic() - begin)
    shutil.rmtree(options.out)
    items = share * options.rounds
    print(f"{items} x {options.command} {options.input}, in {options.rounds} rounds")
    for name, (jobs, total) in seconds.items():
        print(f"{name:14} {total:8.2f} s {items / total:8.2f} items/s "
              f"{seconds[f'parallel -j {jobs}'][1] / total:5.2f} x parallel's rate")


if __name__ == "__main__":
    main()
