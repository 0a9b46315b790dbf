"""The module's numbers are the program's: both run on the same input."""

import json

import numpy as np
import pytest
from conftest import RECORDINGS, TESTDATA, numbers, read_json, read_table, run_program, same, vector

import flextip

MODEL = """format: flextip-model
version: 1
centre_m: [0.4, 0.0, -0.1]
start_ns: 1700000000000000000
effects:
  stiffness: {scale: 0.84}
within_tolerance:
  camera_latency: {delay_s: 0.0006}
sd:
  stiffness: {scale: 0.01}
  camera_latency: {delay_s: 0.0003}
"""

ESTIMATES = {
    "plain": ([], {}),
    "window": (["--window", "20", "--port-prior", "0.003"],
               {"window_samples": 20, "port_prior_m": 0.003}),
    "without positions": (["--without-positions"], {"use_positions": False}),
    "model": (["--model", "MODEL"], {"model": "MODEL"}),
}


@pytest.mark.parametrize("options, arguments", ESTIMATES.values(), ids=ESTIMATES.keys())
def test_estimate(tmp_path, options, arguments):
    model = tmp_path / "model.yaml"
    model.write_text(MODEL)
    recording = RECORDINGS / "sample_2"
    options = [model if option == "MODEL" else option for option in options]
    run_program("estimate", recording, "-o", tmp_path / "out", *options)
    arguments = {k: flextip.read_model(model) if v == "MODEL" else v for k, v in arguments.items()}
    estimates = flextip.estimate(flextip.read_recording(recording), **arguments)

    table = read_table(tmp_path / "out/state0/data.csv")
    summary = read_json(tmp_path / "out/summary.json")
    assert len(estimates) == len(table["status []"]) > 1000
    assert list(estimates.t_ns) == [int(t) for t in table["timestamp [ns]"]]
    assert list(estimates.status) == table["status []"]
    same(estimates.p_RE, vector(table, "p_RE", "m"))
    same(estimates.d_RE, vector(table, "d_RE", ""))
    same(estimates.f_tip_N, vector(table, "f_tip", "N"))
    same(estimates.p_RP, vector(table, "p_RP", "m"))
    same(estimates.s_port_m, numbers(table, "s_port [m]"))
    same(estimates.chi2, numbers(table, "chi2 []"))
    sd = np.sqrt(np.diagonal(estimates.p_RE_covariance_m2, axis1=1, axis2=2))
    same(sd, vector(table, "sd_RE", "m"))
    force_sd = np.sqrt(np.diagonal(estimates.covariance, axis1=1, axis2=2)[:, 6:])
    same(force_sd, vector(table, "sd_f_tip", "N"))
    assert estimates.totals.samples == summary["samples"]
    same(estimates.totals.chi2_per_measurement, summary["chi2_per_measurement"])
    same(estimates.totals.tip_sd_m, summary["tip_sd_m"])
    assert estimates.judgement.grade == summary["verdict"]["grade"]
    assert estimates.judgement.says == summary["verdict"]["says"]
    if "window_samples" in arguments:
        assert estimates.window is not None
        assert estimates.window.status == summary["window"]["status"]
        same(estimates.window.port_shift_m, summary["window"]["port_shift_m"])
    else:
        assert estimates.window is None


@pytest.mark.parametrize("with_model", [True, False], ids=["model", "no model"])
def test_track(tmp_path, with_model):
    recording = RECORDINGS / "rendered"
    truth = RECORDINGS / "rendered.truth.csv"
    options = ["--truth", truth] + ([] if with_model else ["--no-model"])
    run_program("track", recording, "-o", tmp_path / "out", *options)
    track = flextip.track(recording, with_model=with_model, truth=truth)

    tips = read_table(tmp_path / "out/vision0/data.csv")
    frames = read_table(tmp_path / "out/frames.csv")
    summary = read_json(tmp_path / "out/summary.json")
    assert list(track.t_ns) == [int(t) for t in tips["timestamp [ns]"]]
    assert list(track.status) == tips["status []"]
    assert list(track.source) == frames["source []"]
    assert list(track.tags_used) == [int(n) for n in frames["tags_used []"]]
    same(track.p_RE, vector(tips, "p_RE", "m"))
    same(track.vision0.p_RE, track.p_RE)
    same(track.vision0.d_RE, vector(tips, "d_RE", ""))
    same(track.covariance_m2[:, 0, 2], numbers(tips, "cov_xz [m2]"))
    assert track.totals.ok == summary["ok"] == 8
    same(track.totals.tip_rms_error_m, summary["tip_rms_error_m"])
    same(track.totals.tip_mean_nees, summary["tip_mean_nees"])
    assert track.judgement.grade == summary["verdict"]["grade"]


def test_track_pictures(tmp_path):
    pictures = RECORDINGS / "rendered/cam0/data"
    camera = RECORDINGS / "rendered/cam0/sensor.yaml"
    collar = RECORDINGS / "rendered/tags0/sensor.yaml"
    run_program("track", pictures, "--camera", camera, "--collar", collar, "--rate", "25",
                "--frames", "4", "-o", tmp_path / "out")
    track = flextip.track(pictures, camera=camera, collar=collar, rate_hz=25, max_frames=4)
    tips = read_table(tmp_path / "out/vision0/data.csv")
    assert list(track.t_ns) == [int(t) for t in tips["timestamp [ns]"]] and len(track) == 4
    same(track.p_RE, vector(tips, "p_RE", "m"))
    assert track.totals.tip_rms_error_m is None


def parameters(listed):
    return {effect: {name: (list(p.value), list(p.sd)) for name, p in by_name.items()}
            for effect, by_name in listed.items()}


def from_json(listed):
    as_list = lambda value: value if isinstance(value, list) else [value]
    return {effect: {name: (as_list(p["value"]), as_list(p["sd"])) for name, p in by_name.items()}
            for effect, by_name in listed.items()}


def test_diagnose(tmp_path):
    recording = RECORDINGS / "sample_2"
    run_program("diagnose", recording, "-o", tmp_path / "out")
    diagnosis = flextip.diagnose(flextip.read_recording(recording))

    answer = read_json(tmp_path / "out/diagnosis.json")
    summary = read_json(tmp_path / "out/summary.json")
    assert diagnosis.verdicts == answer["verdicts"] == ["stiffness"]
    assert diagnosis.judgement.says == summary["verdict"]["says"]
    listed = {h: p for h, p in diagnosis.probabilities.items() if h in answer["probabilities"]}
    assert listed.keys() == answer["probabilities"].keys()
    same([listed[h] for h in answer["probabilities"]], list(answer["probabilities"].values()))
    assert diagnosis.presence == answer["presence"]
    assert parameters(diagnosis.parameters) == from_json(answer["parameters"])
    assert parameters(diagnosis.within_tolerance) == from_json(answer["within_tolerance"])
    same(diagnosis.base.chi2_per_dof, answer["base"]["chi2_per_dof"])
    assert diagnosis.extended.heldout_rms == answer["extended"]["heldout_rms"]
    assert diagnosis.gain is not None
    same(diagnosis.gain.heldout_error_ratio, answer["gain"]["heldout_error_ratio"])
    interval = answer["gain"]["heldout_error_ratio_interval"]
    same(diagnosis.gain.heldout_error_ratio_interval, interval)
    runs = {gain.controller: gain for gain in diagnosis.closed_loop}
    assert runs.keys() == {run["controller"] for run in answer["closed_loop_runs"]}
    for run in answer["closed_loop_runs"]:
        same(runs[run["controller"]].base_rms_m, run["before"]["rms_deviation_m"])
        same(runs[run["controller"]].extended_max_m, run["after"]["max_deviation_m"])
    flextip.write_model(tmp_path / "model.yaml", diagnosis.model)
    assert (tmp_path / "model.yaml").read_text() == (tmp_path / "out/model.yaml").read_text()

    table = read_table(tmp_path / "out/residuals.csv")
    assert diagnosis.residual_columns == list(table)
    present = np.array([[cell != "" for cell in column] for column in table.values()]).T
    np.testing.assert_array_equal(diagnosis.residuals_present, present)
    np.testing.assert_allclose(diagnosis.residuals, numbers(table, *table), rtol=1e-5)


def test_simulate(tmp_path):
    scenario = TESTDATA / "scenarios/chapter4_up.yaml"
    run_program("simulate", scenario, "-o", tmp_path / "out")
    simulation = flextip.simulate(scenario)
    controllers = read_json(tmp_path / "out/summary.json")["controllers"]
    assert simulation.runs.keys() == controllers.keys() and len(controllers) == 6
    for name, run in simulation.runs.items():
        table = read_table(tmp_path / "out" / name / "deviation.csv")
        assert list(run.t_ns) == [int(t) for t in table["timestamp [ns]"]]
        same(run.p_RE, vector(table, "p_RE", "m"))
        same(run.deviation_m, numbers(table, "deviation [m]"))
        same(run.max_deviation_m, controllers[name]["max_deviation_m"])
        assert run.control_statuses == controllers[name]["control_statuses"]
    name = "rod-track"
    flextip.write_recording(tmp_path / "ours", simulation.runs[name].recording,
                            simulation.runs[name].truth)
    for file in ("recording.yaml", "wrist0/data.csv", "em0/data.csv", "truth0/data.csv"):
        theirs = tmp_path / "out" / name / file
        assert (tmp_path / "ours" / file).read_text() == theirs.read_text()


def test_simulate_renders(tmp_path):
    scenario = TESTDATA.parent / "examples/clip.yaml"
    run_program("simulate", scenario, "--render", "-o", tmp_path / "out")
    seen = []
    simulation = flextip.simulate(
        scenario, render=True, on_frame=lambda name, t_ns, image: seen.append((name, t_ns, image)))
    (name, run), = simulation.runs.items()
    table = read_table(tmp_path / "out/deviation.csv")
    same(run.p_RE, vector(table, "p_RE", "m"))
    assert [f"{t_ns}.png" for _, t_ns, _ in seen] == run.recording.cam0.filenames
    assert all(image.dtype == np.uint8 and image.ndim == 3 for _, _, image in seen)
    from PIL import Image
    theirs = np.asarray(Image.open(tmp_path / f"out/cam0/data/{seen[0][1]}.png"))[..., ::-1]
    np.testing.assert_array_equal(seen[0][2], theirs)


def test_shape():
    arguments = ["--length", "0.6", "--stiffness", "0.304", "--wrist", "0,0,0", "--port",
                 "0.28,0,0", "--force", "0,0,-2"]
    for model in ("rod", "beam", "straight"):
        theirs = json.loads(run_program("shape", *arguments, "--model", model, "--json").stdout)
        ours = flextip.solve_shape(0.6, 0.304, [0, 0, 0], [0.28, 0, 0], [0, 0, -2], model=model)
        assert ours.status == theirs["status"] == "ok"
        same(ours.p_tip, theirs["p_tip_m"])
        same(ours.f_port, theirs["f_port_on_shaft_N"])
