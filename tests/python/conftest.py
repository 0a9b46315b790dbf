"""What the tests share: the program, its files, the data of the repository."""

import csv
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

PROGRAM = os.environ["FLEXTIP_PROGRAM"]
SOURCE = Path(os.environ["FLEXTIP_SOURCE_DIR"])
TESTDATA = SOURCE / "testdata"
RECORDINGS = TESTDATA / "recordings"


def run_program(*arguments):
    """Runs flextip and returns what it did; the test fails where the program does."""
    command = [PROGRAM, "--quiet", *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done


def read_table(file):
    """Returns a CSV's columns by name: texts, empty where a cell is."""
    with open(file, newline="") as lines:
        rows = list(csv.reader(lines))
    names = [name.lstrip("#") for name in rows[0]]
    return {name: [row[i] for row in rows[1:]] for i, name in enumerate(names)}


def numbers(table, *names):
    """Returns columns as (N, columns) or (N,), zeros for empty cells."""
    columns = [[float(cell) if cell else 0.0 for cell in table[name]] for name in names]
    return np.array(columns[0]) if len(names) == 1 else np.array(columns).T


def vector(table, name, unit):
    return numbers(table, *(f"{name}_{axis} [{unit}]" for axis in "xyz"))


def read_json(file):
    return json.loads(Path(file).read_text())


def same(ours, theirs):
    """Equal to rounding: the program's tables hold every digit."""
    np.testing.assert_allclose(ours, theirs, rtol=1e-12, atol=1e-15)


@pytest.fixture(scope="session")
def picture():
    """Reads a PNG as a camera's picture: uint8, blue, green, red."""
    from PIL import Image

    def read(file):
        image = np.asarray(Image.open(file))
        return np.ascontiguousarray(image[..., ::-1]) if image.ndim == 3 else image

    return read
