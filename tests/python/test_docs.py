"""The pages' Python runs: every block of docs/usage/python.md and README.md, in order."""

import contextlib
import io
import re
import shutil

import numpy as np
import pytest
from conftest import RECORDINGS, SOURCE, TESTDATA

import flextip


def blocks(page):
    return re.findall(r"```python\n(.*?)```", (SOURCE / page).read_text(), re.DOTALL)


def reader(folder, picture, recording):
    """Puts the files that the pages name into `folder`; returns the names they take as given."""
    shutil.copytree(RECORDINGS / recording, folder / "recording")
    shutil.copy(TESTDATA / "scenarios/chapter4_up.yaml", folder / "scenario.yaml")
    (folder / "calibration.yaml").write_text(
        "format: flextip-calibration\nversion: 1\nkind: stiffness\nfound:\n"
        "  instrument.bending_stiffness_Nm2: 0.25\n")
    read = flextip.read_recording(folder / "recording")
    names = {"flextip": flextip, "recording": read, "t_ns": read.wrist0.t_ns,
             "p_RW": read.wrist0.p_RW}
    if recording == "rendered":
        names["t_ns"] = int(read.cam0.t_ns[0])
        names["wrist"] = flextip.readings_at(read, names["t_ns"]).wrist
        names["picture"] = picture(folder / "recording/cam0/data" / read.cam0.filenames[0])
    return names


def test_blocks(tmp_path, picture, monkeypatch):
    load, port = np.array([0.0, 0.0, -1.0]), np.array([0.0, 0.0, 0.17])
    wrist = np.array([-0.2457, 0.0, 0.3421])
    tip = flextip.Rod(0.6, 0.304).solve(wrist, port, load).tip.p
    given = [
        ("sample_2", {}), ("sample_2", {}), ("sample_2", {}), ("rendered", {}),
        ("rendered", {"p_RW": wrist, "p_RE": tip, "covariance_m2": 1e-8 * np.eye(3),
                      "p_RE_desired": tip + [0, 0, 0.001]}),
        ("sample_2", {"p_wrist": wrist, "p_port": port, "f_tip": load}),
        ("sample_2", {}),
    ]
    pages = blocks("docs/usage/python.md") + blocks("README.md")
    assert len(pages) == len(given)
    made = {}
    for i, (text, (recording, more)) in enumerate(zip(pages, given)):
        folder = tmp_path / str(i)
        names = reader(folder, picture, recording) | more
        monkeypatch.chdir(folder)
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile(text, f"block {i}", "exec"), names)
        made |= names
    assert made["diagnosis"].verdicts == ["stiffness"]
    assert made["command"].status == "ok" and made["found"].status == "ok"
    assert made["state"].status == "ok"


def test_a_wrong_block_would_fail():
    with pytest.raises(AttributeError):
        exec("flextip.estimates()", {"flextip": flextip})
