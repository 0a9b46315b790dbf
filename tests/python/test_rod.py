"""The models of the shaft against the reference's equilibria and central differences."""

import csv

import numpy as np
import pytest
from conftest import TESTDATA

import flextip

WRIST, PORT = np.array([0.0, 0.0, 0.0]), np.array([0.28, 0.01, 0.0])
FORCE = np.array([0.3, -0.4, -1.6])


def equilibria():
    with open(TESTDATA / "reference/rod_equilibria.csv", newline="") as lines:
        for row in csv.DictReader(line.lstrip("#") for line in lines):
            def vector(name, row=row):
                return np.array([float(row[f"{name}_{axis}"]) for axis in "xyz"])
            yield float(row["length_m"]), float(row["bending_stiffness_Nm2"]), vector, row


def test_reference_equilibria():
    count = 0
    for length_m, stiffness, vector, row in equilibria():
        rod = flextip.Rod(length_m, stiffness, vector("q_weight_N_per_m"))
        state = rod.solve(vector("p_wrist_m"), vector("p_port_m"), vector("f_tip_N"))
        assert state.status == "ok"
        np.testing.assert_allclose(state.tip.p, vector("p_tip_m"), atol=1e-7)
        np.testing.assert_allclose(state.wrist.t, vector("t_wrist"), atol=1e-6)
        assert state.s_port_m == pytest.approx(float(row["s_port_m"]), abs=1e-7)
        np.testing.assert_allclose(state.f_port, vector("f_port_on_shaft_N"), atol=1e-4)
        half = rod.section(state.s_port_m / 2)
        np.testing.assert_allclose(half.m, vector("m_at_half_wrist_segment_Nm"), atol=1e-5)
        count += 1
    assert count == 150


def differences(function, at, step=1e-6):
    """d function / d at by central differences."""
    columns = []
    for i in range(3):
        h = np.zeros(3)
        h[i] = step
        columns.append((function(at + h) - function(at - h)) / (2 * step))
    return np.array(columns).T


def test_jacobian_of_the_rod():
    rod = flextip.Rod(0.6, 0.304)
    state = rod.solve(WRIST, PORT, FORCE)
    tip = lambda wrist: flextip.Rod(0.6, 0.304).solve(wrist, PORT, FORCE).tip.p
    np.testing.assert_allclose(state.J_tip_wrist, differences(tip, WRIST), atol=1e-5)
    np.testing.assert_array_equal(state.J_tip_wrist, state.tip.dp[:, :3])
    by_port = lambda port: flextip.Rod(0.6, 0.304).solve(WRIST, port, FORCE).tip.p
    np.testing.assert_allclose(state.tip.dp[:, 3:6], differences(by_port, PORT), atol=1e-5)
    by_force = lambda force: flextip.Rod(0.6, 0.304).solve(WRIST, PORT, force).tip.p
    np.testing.assert_allclose(state.tip.dp[:, 6:], differences(by_force, FORCE), atol=1e-5)


def test_jacobian_in_tissue():
    """Where the load follows the tip, a fixed point of tip and force gives the same derivative."""
    tissue = -20.0 * np.eye(3)
    state = flextip.Rod(0.6, 0.304).solve(WRIST, PORT, FORCE)

    def tip(wrist):
        rod, p = flextip.Rod(0.6, 0.304), state.tip.p
        for _ in range(200):
            p = p + 0.2 * (rod.solve(wrist, PORT, FORCE + tissue @ (p - state.tip.p)).tip.p - p)
        return p
    np.testing.assert_allclose(state.jacobian(tissue), differences(tip, WRIST, 1e-5), atol=1e-4)
    np.testing.assert_allclose(state.jacobian(np.zeros((3, 3))), state.J_tip_wrist, atol=1e-12)


def test_beam_is_near_the_rod_under_a_small_load():
    small = np.array([0.0, 0.0, -0.05])
    rod = flextip.Rod(0.6, 0.304).solve([0, 0, 0], [0.28, 0, 0], small)
    beam = flextip.solve_beam([0, 0, 0], [0.28, 0, 0], small, 0.304, 0.6)
    assert beam.status == "ok"
    np.testing.assert_allclose(beam.p_tip, rod.tip.p, atol=1e-5)
    np.testing.assert_allclose(beam.jacobian(), rod.J_tip_wrist, atol=0.01)
    by_port_force = beam.jacobian("port_force")
    assert np.abs(by_port_force - beam.jacobian("tip_force")).max() > 1e-6
    with pytest.raises(flextip.InputError, match="moment"):
        beam.jacobian("moment")


def test_shapes_end_at_the_tip():
    shape = flextip.solve_shape(0.6, 0.304, WRIST, PORT, FORCE)
    np.testing.assert_allclose(shape.points[0], WRIST, atol=1e-9)
    np.testing.assert_allclose(shape.points[-1], shape.p_tip, atol=1e-9)
    length = np.linalg.norm(np.diff(shape.points, axis=0), axis=1).sum()
    assert length == pytest.approx(0.6, rel=1e-4)


def test_section_is_refused_outside():
    rod = flextip.Rod(0.6, 0.304)
    rod.solve(WRIST, PORT, FORCE)
    for s_m in (-0.01, 0.61, np.nan):
        with pytest.raises(flextip.InputError, match="s_m"):
            rod.section(s_m)
    rod.reset()
    with pytest.raises(flextip.InputError):
        rod.section(0.1)
