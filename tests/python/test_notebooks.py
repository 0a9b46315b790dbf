"""Every notebook runs from top to bottom (nbconvert --execute); its page is left to look at."""

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from conftest import SOURCE

pytest.importorskip("nbconvert")
pytest.importorskip("ipykernel")
pytest.importorskip("matplotlib")

FOLDER = SOURCE / "python/notebooks"
PAGES = Path(os.environ["FLEXTIP_BINARY_DIR"]) / "python/notebooks"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))


def test_there_is_one_a_task():
    assert [file.stem for file in NOTEBOOKS] == ["control", "diagnose", "estimate", "rod", "track"]


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda file: file.stem)
def test_runs(notebook):
    start = time.monotonic()
    done = subprocess.run([sys.executable, "-m", "nbconvert", "--to", "html", "--execute",
                           "--output-dir", str(PAGES), str(notebook)],
                          capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]
    page = (PAGES / f"{notebook.stem}.html").read_text()
    assert "data:image/png" in page or "<svg" in page
    print(f"{notebook.stem}: {time.monotonic() - start:.1f} s")


@pytest.mark.parametrize("notebook", NOTEBOOKS, ids=lambda file: file.stem)
def test_is_kept_without_outputs(notebook):
    cells = json.loads(notebook.read_text())["cells"]
    assert not any(cell.get("outputs") for cell in cells)
    assert not any(cell.get("execution_count") for cell in cells)
