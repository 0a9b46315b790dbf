#!/usr/bin/env python3
"""A cluster on paper: how long a batch takes by the measured times of its items.

    makespan.py TABLE.csv [--hand-out-us 100]

Items draw their times from the column `seconds` of a batch's table. Rank 0 hands out one at a time,
the largest first, and needs --hand-out-us for each; every rank works. Prints the makespan, and the
share of it in which the ranks work.
"""
import argparse
import csv
import heapq
import random


def makespan(times_s, ranks, hand_out_s):
    """Returns when the last item ends. A rank that is free waits for its turn at rank 0."""
    free = [0.0] * ranks
    turn = last = 0.0
    for time_s in sorted(times_s, reverse=True):
        turn = max(turn, heapq.heappop(free)) + hand_out_s
        last = max(last, turn + time_s)
        heapq.heappush(free, turn + time_s)
    return last


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table")
    parser.add_argument("--hand-out-us", type=float, default=100.0)
    options = parser.parse_args()
    with open(options.table, newline="", encoding="utf-8") as file:
        measured = [float(row["seconds"]) for row in csv.DictReader(file)]
    print(f"items of {min(measured):.2f} to {max(measured):.2f} s, "
          f"mean {sum(measured) / len(measured):.2f} s")
    for items in (1000, 100000):
        times = random.Random(1).choices(measured, k=items)
        for ranks in (64, 1024):
            whole = makespan(times, ranks, 1e-6 * options.hand_out_us)
            print(f"{items:7} recordings, {ranks:5} ranks: {whole:9.1f} s, "
                  f"{100 * sum(times) / ranks / whole:5.1f} % at work")


if __name__ == "__main__":
    main()
