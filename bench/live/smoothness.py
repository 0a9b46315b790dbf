#!/usr/bin/env python3
"""Says how smooth the set-points of a recorded session are: smoothness.py RECORDING

Of the cycles in which the robot moved: the set-point's speed, the change of its velocity from one
cycle to the next, and the same over the cycles in which a new tip was used. In a loop that steps at
each tip and stands between two, all of the motion is in those cycles: their share of the way is 1.
"""
import csv
import math
import statistics
import sys


def moves(file):
    """Yields for each pair of moving cycles: the step (m) and whether a new tip came with it."""
    with open(file, newline="", encoding="utf-8") as text:
        rows = csv.reader(text)
        head = next(rows)
        hold, tip_t = head.index("hold"), head.index("vision0 t [ns]")
        place = [head.index(f"command [m]_{i}") for i in range(3)]
        last, last_tip = None, None
        for row in rows:
            tip = row[tip_t]
            if row[hold] != "0":
                last = None
            else:
                command = [float(row[i]) for i in place]
                if last is not None:
                    yield [a - b for a, b in zip(command, last)], bool(tip) and tip != last_tip
                last = command
            last_tip = tip or last_tip


def main():
    if len(sys.argv) != 2:
        raise SystemExit(__doc__)
    steps, new = zip(*moves(f"{sys.argv[1]}/session0/cycles.csv"))
    lengths = [math.hypot(*step) for step in steps]
    changes = [math.dist(a, b) for a, b in zip(steps[1:], steps)]
    by_new = [c for c, n in zip(changes, new[1:]) if n]
    others = [c for c, n in zip(changes, new[1:]) if not n]
    share = sum(n for n in new) / len(new)
    way = sum(s for s, n in zip(lengths, new) if n) / sum(lengths)
    print(f"{len(steps)} steps, {share:.3f} of them with a new tip, and {way:.3f} of the way")
    for name, values in (("step", lengths), ("change of step", changes),
                         ("  with a new tip", by_new), ("  between", others)):
        if len(values) < 2:
            continue
        cut = statistics.quantiles(values, n=100)
        print(f"{name:18} um: median {1e6 * cut[49]:.1f}, 95 % {1e6 * cut[94]:.1f}, "
              f"largest {1e6 * max(values):.1f}")


if __name__ == "__main__":
    main()
