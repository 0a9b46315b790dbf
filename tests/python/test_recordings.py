"""Recordings: arrays as in the files, written and read again, changed in Python."""

import numpy as np
import pytest
from conftest import RECORDINGS, numbers, read_table, same, vector

import flextip


def test_streams_are_the_files_columns():
    recording = flextip.read_recording(RECORDINGS / "sample_0")
    folder = RECORDINGS / "sample_0"
    wrist, em, strain, load, vision = (read_table(folder / name / "data.csv") for name in (
        "wrist0", "em0", "strain0", "load0", "vision0"))
    assert recording.wrist0.t_ns.dtype == np.int64
    assert list(recording.wrist0.t_ns) == [int(t) for t in wrist["timestamp [ns]"]]
    same(recording.wrist0.p_RW, vector(wrist, "p_RW", "m"))
    q = numbers(em, "q_RS_w []", "q_RS_x []", "q_RS_y []", "q_RS_z []")
    np.testing.assert_allclose(recording.em0.q_RS, q, atol=1e-8)  # normalised
    same(recording.em0.p_RS, vector(em, "p_RS", "m"))
    moments = numbers(strain, "m1_y [Nm]", "m1_z [Nm]", "m2_y [Nm]", "m2_z [Nm]")
    same(recording.strain0.moments_Nm, moments)
    same(recording.load0.f_tip_N, vector(load, "f", "N"))
    assert list(recording.vision0.status) == vision["status []"]
    same(recording.vision0.covariance_m2[:, 1, 2], numbers(vision, "cov_yz [m2]"))
    assert recording.command0 is None and recording.em1 is None
    assert 0 < recording.strain0.stations_from_wrist_m[0] < recording.instrument.length_m


def parts(recording):
    """Every array and number of a recording, by name."""
    found = {"p_RP": recording.p_RP, "gravity": recording.gravity_m_s2}
    for name in ("instrument", "wrist0", "em0", "strain0", "load0", "vision0"):
        part = getattr(recording, name)
        for attribute in (a for a in dir(part) if not a.startswith("_")):
            found[f"{name}.{attribute}"] = getattr(part, attribute)
    return found


def test_written_and_read_again(tmp_path):
    recording = flextip.read_recording(RECORDINGS / "sample_2")
    flextip.write_recording(tmp_path / "again", recording)
    again = parts(flextip.read_recording(tmp_path / "again"))
    first = parts(recording)
    assert len(first) > 40
    for name, value in first.items():
        np.testing.assert_array_equal(again[name], value, err_msg=name)


def test_a_recording_made_of_arrays(tmp_path):
    first = flextip.read_recording(RECORDINGS / "sample_2")
    made = flextip.Recording(first.instrument, first.p_RP, first.gravity_m_s2)
    wrist, em = first.wrist0, first.em0
    made.wrist0 = flextip.WristStream(wrist.t_ns, wrist.p_RW, wrist.q_RW, rate_hz=wrist.rate_hz,
                                      position_noise_m=wrist.position_noise_m,
                                      orientation_noise_rad=wrist.orientation_noise_rad)
    made.em0 = flextip.EmStream(em.t_ns, em.p_RS, em.q_RS, rate_hz=em.rate_hz,
                                distance_from_tip_m=em.distance_from_tip_m,
                                position_noise_m=em.position_noise_m,
                                orientation_noise_rad=em.orientation_noise_rad)
    only = first.copy()
    only.strain0 = only.load0 = only.vision0 = None
    assert first.strain0 is not None
    same(flextip.estimate(made).f_tip_N, flextip.estimate(only).f_tip_N)
    flextip.write_recording(tmp_path / "made", made)
    same(flextip.read_recording(tmp_path / "made").em0.q_RS, em.q_RS)
    with pytest.raises(flextip.InputError, match="empty"):
        flextip.write_recording(tmp_path / "made", made)


def test_streams_outlive_their_recording():
    recording = flextip.read_recording(RECORDINGS / "sample_0")
    wrist = recording.wrist0
    p_RW = wrist.p_RW.copy()
    recording.wrist0 = None
    del recording
    np.testing.assert_array_equal(wrist.p_RW, p_RW)
    with pytest.raises(AttributeError):
        wrist.rate_hz = 3.0


def test_tips_found_replace_those_recorded(tmp_path):
    from conftest import run_program
    run_program("track", RECORDINGS / "rendered", "-o", tmp_path / "track")
    tracked = flextip.read_recording(RECORDINGS / "rendered", tracked=tmp_path / "track")
    assert tracked.vision0 is not None
    by_hand = flextip.read_recording(RECORDINGS / "rendered")
    assert by_hand.vision0 is None
    by_hand.vision0 = flextip.track(RECORDINGS / "rendered").vision0
    same(flextip.estimate(by_hand).p_RE, flextip.estimate(tracked).p_RE)


def test_a_calibration_replaces_values(tmp_path):
    file = tmp_path / "calibration.yaml"
    file.write_text("format: flextip-calibration\nversion: 1\nkind: stiffness\nfound:\n"
                    "  instrument.bending_stiffness_Nm2: 0.25\n")
    recording = flextip.read_recording(RECORDINGS / "sample_0", calibrations=[file])
    assert recording.instrument.bending_stiffness_Nm2 == 0.25


def test_truth(tmp_path):
    assert flextip.read_truth(RECORDINGS / "sample_0") is None


def test_camera_and_collar():
    camera = flextip.read_camera(RECORDINGS / "rendered/cam0/sensor.yaml")
    collar = flextip.read_collar(RECORDINGS / "rendered/tags0/sensor.yaml")
    recording = flextip.read_recording(RECORDINGS / "rendered")
    np.testing.assert_array_equal(camera.T_RC, recording.cam0.camera.T_RC)
    np.testing.assert_array_equal(camera.intrinsics, recording.cam0.camera.intrinsics)
    assert [tag.id for tag in collar.tags] == [tag.id for tag in recording.tags0.tags]
    made = flextip.Camera(camera.intrinsics, camera.resolution, camera.T_RC,
                          distortion_model=camera.distortion_model,
                          distortion_coefficients=camera.distortion_coefficients,
                          gamma=camera.gamma)
    np.testing.assert_array_equal(made.T_RC, camera.T_RC)
    assert len(recording.cam0.filenames) == len(recording.cam0.t_ns) == 8
