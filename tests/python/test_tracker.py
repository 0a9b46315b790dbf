"""Tracker: a picture at a time finds what track() finds in the whole recording."""

import numpy as np
import pytest
from conftest import RECORDINGS, same

import flextip


@pytest.mark.parametrize("with_model", [True, False], ids=["model", "no model"])
def test_a_picture_at_a_time(picture, with_model):
    recording = flextip.read_recording(RECORDINGS / "rendered")
    whole = flextip.track(RECORDINGS / "rendered", with_model=with_model)
    tracker = flextip.Tracker(recording, with_model=with_model)
    for i, (t_ns, name) in enumerate(zip(recording.cam0.t_ns, recording.cam0.filenames)):
        image = picture(RECORDINGS / "rendered/cam0/data" / name)
        found = tracker.track(image, int(t_ns), flextip.readings_at(recording, int(t_ns)))
        assert found.status == whole.status[i] == "ok"
        same(found.p_RE, whole.p_RE[i])
        same(found.covariance_m2, whole.covariance_m2[i])
        same(found.T_RE[:3, 3], found.p_RE)
        same(found.T_RE[:3, 0], found.d_RE)
        assert found.tags_used == whole.tags_used[i] >= len({tag.id for tag in found.tags}) > 0
        assert found.tags[0].corners_px.shape == (4, 2)


def test_without_a_recording(picture):
    """A camera and a collar are enough; the tip is where the truth has it."""
    folder = RECORDINGS / "rendered"
    setup = flextip.Recording(flextip.Instrument(0.6, 0.304), [0, 0, 0])
    setup.cam0 = flextip.CameraStream(flextip.read_camera(folder / "cam0/sensor.yaml"))
    setup.tags0 = flextip.read_collar(folder / "tags0/sensor.yaml")
    tracker = flextip.Tracker(setup, with_model=False)
    truth = np.loadtxt(RECORDINGS / "rendered.truth.csv", delimiter=",")
    for file, row in zip(sorted((folder / "cam0/data").iterdir()), truth):
        found = tracker.track(picture(file), int(file.stem))
        assert found.status == "ok" and found.source in ("pixels", "corners")
        error = found.p_RE - row[1:4]
        assert np.linalg.norm(error) < 1e-3
        assert error @ np.linalg.solve(found.covariance_m2, error) < 25


def test_grey_and_stereo(picture):
    recording = flextip.read_recording(RECORDINGS / "rendered")
    file = RECORDINGS / "rendered/cam0/data" / recording.cam0.filenames[0]
    colour = picture(file)
    if colour.ndim == 2:
        colour = np.repeat(colour[..., None], 3, axis=2)
    alone = flextip.Tracker(recording, with_model=False).track(colour, 0)
    recording.cam1 = recording.cam0
    both = flextip.Tracker(recording, with_model=False)
    assert both.track_stereo([colour, None], 0).p_RE == pytest.approx(alone.p_RE, abs=1e-6)
    twice = both.track_stereo([colour, colour[..., 0].copy()], 33_000_000)
    assert twice.tags_used > alone.tags_used
    with pytest.raises(flextip.InputError):
        both.track(colour, 66_000_000)
