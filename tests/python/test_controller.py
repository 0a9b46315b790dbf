"""Controller: closed loops in Python about the exact rod, and the cycle of the README's example."""

import numpy as np
import pytest
from conftest import RECORDINGS

import flextip

INSTRUMENT = flextip.Instrument(0.6, 0.304)
PORT = np.array([0.28, 0.0, 0.0])
FORCE = np.array([0.0, 0.0, -1.5])


def setup():
    return flextip.Recording(INSTRUMENT, PORT, [0, 0, 0])


def readings(t_ns, wrist, tip):
    return flextip.Readings(
        wrist=flextip.WristReading(t_ns, wrist, position_noise_m=5e-5),
        tip=flextip.TipReading(t_ns, tip, 1e-8 * np.eye(3)))


def closed_loop(kind, goal, cycles=12, **options):
    """Moves the tip of a rod under a force to `goal`; returns the last distance and command."""
    rod, controller = flextip.Rod(0.6, 0.304), flextip.Controller(setup(), kind=kind, **options)
    wrist = np.zeros(3)
    for cycle in range(cycles):
        t_ns = cycle * 33_000_000
        tip = rod.solve(wrist, PORT, FORCE).tip.p
        command = controller.step(t_ns, readings(t_ns, wrist, tip), goal)
        wrist = command.p_RW_command
    return np.linalg.norm(rod.solve(wrist, PORT, FORCE).tip.p - goal), command


def start():
    return flextip.Rod(0.6, 0.304).solve(np.zeros(3), PORT, FORCE).tip.p


@pytest.mark.parametrize("kind", ["straight-track", "flex-track", "rod-track"])
def test_tracking_controllers_arrive(kind):
    left, command = closed_loop(kind, start() + [0.0, 0.006, 0.008])
    assert command.status in ("ok", "straight_instead") and left < 1e-4
    np.testing.assert_allclose(command.p_RE_measured, command.p_RE_used, atol=1e-3)


def late_loop(**options):
    """A loop whose tip is two cycles late; returns the tip's distances from the goal."""
    rod, controller = flextip.Rod(0.6, 0.304), flextip.Controller(setup(), **options)
    goal, wrist, tips, distances = start() + [0.0, 0.006, 0.008], np.zeros(3), [], []
    for cycle in range(40):
        t_ns = cycle * 33_000_000
        tips.append((t_ns, rod.solve(wrist, PORT, FORCE).tip.p))
        distances.append(np.linalg.norm(tips[-1][1] - goal))
        now = flextip.WristReading(t_ns, wrist, position_noise_m=5e-5)
        tip = flextip.TipReading(*tips[max(cycle - 2, 0)], 1e-8 * np.eye(3))
        command = controller.step(t_ns, flextip.Readings(wrist=now, tip=tip), goal)
        wrist = command.p_RW_command
    return np.array(distances)


def test_a_late_tip_costs_little_and_a_doubtful_one_gain():
    told = late_loop()
    assert told[-1] < 1e-4
    doubtful = late_loop(rate_hz=30, tip_time_sd_s=0.03)
    assert doubtful[-1] < 1e-3
    assert doubtful[4] > 1.5 * told[4]  # by the smaller gain
    with pytest.raises(flextip.InputError, match="tip_time_sd_s"):
        flextip.Controller(setup(), tip_time_sd_s=-1)


def test_calculating_with_a_straight_shaft_does_not():
    left, _ = closed_loop("straight-calculate", start() + [0.0, 0.006, 0.008])
    assert left > 1e-3


def test_the_load_is_found():
    _, command = closed_loop("rod-track", start(), port_prior_m=1e-6)
    assert command.estimate.status == "ok"
    covariance = command.estimate.covariance[6:, 6:]
    error = command.estimate.f_tip_N - FORCE
    assert error @ np.linalg.solve(covariance, error) < 20
    variances, directions = np.linalg.eigh(covariance)
    along = directions[:, 2] @ command.estimate.d_RE  # along the shaft it is hardly known
    assert np.sqrt(variances[1]) < 0.1 < np.sqrt(variances[2]) and abs(along) > 0.8


def test_fixtures_keep_the_tip_out():
    floor = start() - [0, 0, 0.002]
    left, command = closed_loop("rod-track", start() - [0, 0, 0.01],
                                fixtures=[flextip.HalfSpace(floor, [0, 0, 2])], margin_m=0.001)
    assert command.fixture_status == "moved"
    assert command.p_RE_desired[2] == pytest.approx(floor[2] + 0.001, abs=1e-9)
    assert left > 0.008
    path = flextip.PathGuidance(np.array([start(), start() + [0, 0.02, 0]]))
    assert path.length_m == pytest.approx(0.02)
    _, guided = closed_loop("rod-track", start() + [0, 0.01, 0.005], fixtures=[path])
    assert guided.p_RE_desired[2] == pytest.approx(start()[2], abs=1e-9)
    sphere = flextip.Sphere(start(), 0.003, forbidden_outside=True)
    _, held = closed_loop("rod-track", start() + [0, 0.01, 0], fixtures=[sphere])
    assert np.linalg.norm(held.p_RE_desired - start()) == pytest.approx(0.003, abs=1e-9)


def test_a_mesh_is_a_fixture():
    from conftest import TESTDATA
    mesh = flextip.Mesh(TESTDATA / "scenarios/box.obj")
    assert mesh.triangles == 12
    closed_loop("rod-track", start(), cycles=2, fixtures=[mesh])


def test_direction_by_the_rod():
    """Where the place matters little, a step turns the tip toward its wished direction."""
    rod = flextip.Rod(0.6, 0.304)
    tip = rod.solve(np.zeros(3), PORT, FORCE).tip
    wish = (tip.t + [0, 0.03, 0]) / np.linalg.norm(tip.t + [0, 0.03, 0])
    little = flextip.DirectionOptions(position_tolerance_m=0.1, direction_tolerance_rad=0.001)
    command = flextip.Controller(setup(), direction=little).step(
        0, readings(0, np.zeros(3), tip.p), tip.p, wish)
    assert command.status == "ok"
    turned = rod.solve(command.p_RW_command, PORT, FORCE).tip.t
    assert np.linalg.norm(turned - wish) < 0.3 * np.linalg.norm(tip.t - wish)


def test_only_watching_and_a_tip_that_grows_old():
    controller = flextip.Controller(setup())
    seen = readings(0, np.zeros(3), start())
    watching = controller.step(0, seen)
    assert watching.status == "no_goal"
    np.testing.assert_array_equal(watching.p_RW_command, np.zeros(3))
    for t_ns, status in [(100_000_000, "ok"), (150_000_000, "no_tip")]:  # carried on for 0.12 s
        wrist_alone = flextip.Readings(
            wrist=flextip.WristReading(t_ns, np.zeros(3), position_noise_m=5e-5))
        assert controller.step(t_ns, wrist_alone, start()).status == status


def test_the_same_inputs_give_the_same_commands():
    goal = start() + [0.0, 0.003, 0.004]
    one, two = (closed_loop("rod-track", goal)[1] for _ in range(2))
    np.testing.assert_array_equal(one.p_RW_command, two.p_RW_command)


def test_a_found_model_is_used(tmp_path):
    file = tmp_path / "model.yaml"
    file.write_text("format: flextip-model\nversion: 1\ncentre_m: [0, 0, 0]\nstart_ns: 0\n"
                    "effects:\n  stiffness: {scale: 0.8}\n")
    model = flextip.read_model(file)
    assert model.effects["stiffness"]["scale"].value == [0.8]
    _, without = closed_loop("rod-track", start())
    _, with_model = closed_loop("rod-track", start(), model=model)
    ratio = with_model.estimate.f_tip_N[2] / without.estimate.f_tip_N[2]
    assert ratio == pytest.approx(0.8, abs=0.02)  # the same bending of a softer shaft


def test_pictures_are_seen(picture):
    recording = flextip.read_recording(RECORDINGS / "rendered")
    controller = flextip.Controller(recording, kind="flex-track", tracker=flextip.TrackerOptions())
    t_ns = int(recording.cam0.t_ns[0])
    image = picture(RECORDINGS / "rendered/cam0/data" / recording.cam0.filenames[0])
    told = flextip.readings_at(recording, t_ns)
    command = controller.step(t_ns, told, pictures=[image])
    found = flextip.track(RECORDINGS / "rendered", max_frames=1)
    np.testing.assert_allclose(command.p_RE_measured, found.p_RE[0], rtol=1e-12)
