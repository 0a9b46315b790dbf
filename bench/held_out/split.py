#!/usr/bin/env python3
"""Splits a recording of stops into one to fit and one to predict.

A row is a stop: all streams have the same time stamps, which are made anew, a second apart. Rows go
by how far their tip is from the port's place, or every other one:

    split.py RECORDING FIT TEST --depths-mm 130 180      # these are for TEST
    split.py RECORDING FIT TEST --every-other
"""
import argparse
import csv
import pathlib
import shutil

TOLERANCE_M = 0.004  # of a depth
FIRST_NS = 1_700_000_000_000_000_000


def rows_of(file):
    with open(file, newline='') as text:
        rows = list(csv.reader(text))
    return rows[0], rows[1:]


def depth_m(row):
    return sum(float(x) ** 2 for x in row[1:4]) ** 0.5


def for_test(recording, arguments):
    """The time stamps of TEST."""
    _, tips = rows_of(recording / 'vision0' / 'data.csv')
    if arguments.every_other:
        return {row[0] for row in tips[1::2]}
    depths_m = [1e-3 * depth for depth in arguments.depths_mm]
    return {row[0] for row in tips
            if any(abs(depth_m(row) - depth) < TOLERANCE_M for depth in depths_m)}


def stamped(rows):
    return [[str(FIRST_NS + k * 10**9)] + row[1:] for k, row in enumerate(rows)]


def write_part(recording, out, keep):
    out.mkdir(parents=True)
    shutil.copy(recording / 'recording.yaml', out)
    for data in sorted(recording.glob('*/data.csv')):
        head, rows = rows_of(data)
        (out / data.parent.name).mkdir()
        for other in data.parent.glob('*.yaml'):
            shutil.copy(other, out / data.parent.name)
        with open(out / data.parent.name / 'data.csv', 'w', newline='') as text:
            kept = stamped([row for row in rows if keep(row[0])])
            csv.writer(text, lineterminator='\n').writerows([head] + kept)


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('recording', type=pathlib.Path)
    parser.add_argument('fit', type=pathlib.Path)
    parser.add_argument('test', type=pathlib.Path)
    way = parser.add_mutually_exclusive_group(required=True)
    way.add_argument('--depths-mm', type=float, nargs='+')
    way.add_argument('--every-other', action='store_true')
    arguments = parser.parse_args()
    test = for_test(arguments.recording, arguments)
    write_part(arguments.recording, arguments.fit, lambda t: t not in test)
    write_part(arguments.recording, arguments.test, lambda t: t in test)


if __name__ == '__main__':
    main()
