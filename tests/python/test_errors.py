"""Bad input is an InputError of one line, an expected failure a status, and never NaN."""

import numpy as np
import pytest
from conftest import RECORDINGS, SOURCE, TESTDATA, run_program

import flextip

T_NS = np.arange(5) * 20_000_000
P = np.zeros((5, 3))
INSTRUMENT = flextip.Instrument(0.6, 0.304)


def wrist(**changes):
    arguments = {"t_ns": T_NS, "p_RW": P, "rate_hz": 50, "position_noise_m": 1e-4} | changes
    return flextip.WristStream(**arguments)


def refused(call, *parts):
    with pytest.raises(flextip.InputError) as error:
        call()
    text = str(error.value)
    assert "\n" not in text
    for part in parts:
        assert part in text, text


def test_an_error_has_the_programs_line(tmp_path):
    import subprocess

    from conftest import PROGRAM
    broken = tmp_path / "recording"
    (broken / "wrist0").mkdir(parents=True)
    (broken / "recording.yaml").write_text((RECORDINGS / "sample_0/recording.yaml").read_text())
    sensor = RECORDINGS / "sample_0/wrist0/sensor.yaml"
    (broken / "wrist0/sensor.yaml").write_text(sensor.read_text())
    lines = (RECORDINGS / "sample_0/wrist0/data.csv").read_text().splitlines()
    lines[7] = lines[7].replace(lines[7].split(",")[1], "nan")
    (broken / "wrist0/data.csv").write_text("\n".join(lines) + "\n")
    theirs = subprocess.run([PROGRAM, "estimate", broken, "-o", tmp_path / "out"],
                            capture_output=True, text=True)
    assert theirs.returncode == 2
    with pytest.raises(flextip.InputError) as ours:
        flextip.read_recording(broken)
    assert theirs.stderr == f"flextip: {ours.value}\n"
    assert "data.csv:8" in str(ours.value)


def test_what_input_errors_are():
    assert issubclass(flextip.InputError, ValueError)
    assert issubclass(flextip.WorkError, RuntimeError)
    assert flextip.InputError.__module__ == "flextip"


def test_arrays_are_checked():
    refused(lambda: wrist(p_RW=np.zeros((5, 4))), "p_RW", "(5, 4)", "expected (5, 3)")
    refused(lambda: wrist(p_RW=np.zeros((4, 3))), "(4, 3)")
    refused(lambda: wrist(p_RW=np.full((5, 3), np.nan)), "p_RW", "NaN")
    refused(lambda: wrist(t_ns=T_NS * 1e-9), "float64", "int64")
    refused(lambda: wrist(t_ns=T_NS[::-1]), "t_ns[1]", "increase")
    refused(lambda: wrist(t_ns=T_NS[:0], p_RW=P[:0]), "no samples")
    refused(lambda: wrist(q_RW=np.full((5, 4), 0.6)), "q_RW[0]", "1.2")
    refused(lambda: wrist(position_noise_m=-1), "position_noise_m", "-1")
    refused(lambda: wrist(rate_hz=0), "rate_hz")
    assert (wrist(q_RW=np.zeros((5, 4))).q_RW == 0).all()  # not measured


def test_settings_are_checked():
    refused(lambda: flextip.Instrument(0, 0.3), "length_m")
    refused(lambda: flextip.CollarTag(1, 0.005, np.diag([1, 1, 1.1, 1])), "T_EG")
    camera = [400, 400, 320, 240], (640, 480), np.eye(4)
    refused(lambda: flextip.Camera(*camera, distortion_model="fov"), "fov")
    refused(lambda: flextip.Camera(*camera, distortion_coefficients=[0, 0]), "2")
    refused(lambda: flextip.Camera([-1, 400, 320, 240], *camera[1:]), "-1")
    refused(lambda: flextip.solve_shape(0.6, 0.3, P[0], [0.3, 0, 0], P[0], model="cubic"), "cubic")
    recording = flextip.Recording(INSTRUMENT, [0.28, 0, 0])
    refused(lambda: flextip.Controller(recording, kind="rod"), "kind", "rod-track")
    refused(lambda: flextip.Controller(recording, kind="flex-track",
                                       direction=flextip.DirectionOptions()), "rod")
    refused(lambda: flextip.Controller(recording, window_samples=1), "window_samples")
    refused(lambda: flextip.Controller(recording, tracker=flextip.TrackerOptions()), "cam0")
    refused(lambda: flextip.Tracker(recording), "cam0")
    refused(lambda: flextip.PathGuidance([[0, 0, 0]]))
    refused(lambda: flextip.HalfSpace([0, 0, 0], [0, 0, 0]), "normal")


def test_commands_refuse_as_the_program_does():
    recording = flextip.read_recording(RECORDINGS / "sample_0")
    refused(lambda: flextip.diagnose(recording, without=["gremlins"]), "gremlins")
    refused(lambda: flextip.estimate(recording, window_samples=1), "window_samples")
    refused(lambda: flextip.estimate(recording, port_prior_m=0), "port_prior_m")
    recording.wrist0 = None
    refused(lambda: flextip.estimate(recording), "wrist0")
    refused(lambda: flextip.track(RECORDINGS / "sample_0"))
    refused(lambda: flextip.track(RECORDINGS / "rendered", camera="cam.yaml"), "collar")
    refused(lambda: flextip.track(RECORDINGS / "rendered", outline="pointed"), "pointed")
    refused(lambda: flextip.track(RECORDINGS / "rendered", black_white=(9, 9)), "black_white")
    refused(lambda: flextip.simulate("nowhere.yaml"), "nowhere.yaml")
    blind = TESTDATA / "scenarios/chapter4_up.yaml"
    refused(lambda: flextip.simulate(blind, render=True), "camera")
    refused(lambda: flextip.simulate(SOURCE / "examples/clip.yaml"), "tip")
    refused(lambda: flextip.simulate(TESTDATA / "scenarios/press.yaml", controllers=["pid"]), "pid")


def test_work_errors(tmp_path):
    file = tmp_path / "model.yaml"
    file.write_text("format: flextip-model\nversion: 1\ncentre_m: [0, 0, 0]\nstart_ns: 0\n"
                    "effects:\n  stiffness: {scale: 0.9}\n")
    with pytest.raises(flextip.WorkError):
        flextip.write_model("/dev/null/model.yaml", flextip.read_model(file))


def test_wrong_types_are_pythons_own_error():
    with pytest.raises(TypeError):
        flextip.estimate("recording")
    with pytest.raises(TypeError):
        flextip.readings_at(flextip.Recording(INSTRUMENT, [0, 0, 0]), 0.5)


def test_an_expected_failure_is_a_status():
    rod = flextip.Rod(0.6, 0.304)
    state = rod.solve([0, 0, 0], [0.7, 0, 0], [0, 0, -2])
    assert state.status == "unreachable"
    assert state.tip is None and state.J_tip_wrist is None and state.jacobian(np.eye(3)) is None
    refused(lambda: rod.section(0.1), "solve")
    bad = rod.solve([np.nan, 0, 0], [0.3, 0, 0])
    assert bad.status == "bad_input" and bad.s_port_m is None
    assert flextip.solve_beam([0, 0, 0], [0.7, 0, 0], [0, 0, -2], 0.304, 0.6).p_tip is None
    controller = flextip.Controller(flextip.Recording(INSTRUMENT, [0.28, 0, 0]))
    command = controller.step(0, flextip.Readings(), [0.6, 0, 0])
    assert command.status == "no_wrist" and command.p_RW_command is None
    assert command.estimate.status == "bad_input" and command.estimate.p_RE is None


def test_a_lost_tip_is_a_row_of_zeros():
    recording = flextip.read_recording(RECORDINGS / "rendered")
    tracker = flextip.Tracker(recording, with_model=False)
    width, height = recording.cam0.camera.resolution
    blank = tracker.track(np.full((height, width, 3), 90, np.uint8), 0)
    assert blank.status == "lost" and blank.p_RE is None and blank.covariance is None
    stream = flextip.VisionStream(T_NS, np.ones((5, 3)), np.zeros((5, 3, 3)),
                                  ["lost"] + ["predicted"] * 4, rate_hz=50)
    assert (stream.p_RE[0] == 0).all() and (stream.p_RE[1:] == 1).all()


def test_pictures_are_checked():
    recording = flextip.read_recording(RECORDINGS / "rendered")
    tracker = flextip.Tracker(recording)
    width, height = recording.cam0.camera.resolution
    refused(lambda: tracker.track(np.zeros((height, width), float), 0), "float64", "uint8")
    refused(lambda: tracker.track(np.zeros((height, width, 4), np.uint8), 0), "4)")
    refused(lambda: tracker.track(np.zeros((10, 10), np.uint8), 0), "10")
    refused(lambda: tracker.track_stereo([None, None], 0), "2")


def test_skipped_data_warns(tmp_path):
    run_program("simulate", TESTDATA / "scenarios/chapter4_up.yaml", "-o", tmp_path / "out")
    file = tmp_path / "out/rod-track/wrist0/data.csv"
    rows = len(file.read_text().splitlines()) - 1
    file.write_text(file.read_text()[:-9])
    with pytest.warns(flextip.RecordingWarning, match="data.csv"):
        recording = flextip.read_recording(tmp_path / "out/rod-track")
    assert len(recording.wrist0.t_ns) == rows - 1
