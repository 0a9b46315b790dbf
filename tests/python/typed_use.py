"""Code of a user, for mypy: it must pass with --strict, and each line marked WRONG must not."""

import numpy as np
from numpy.typing import NDArray

import flextip


def estimated_force(folder: str) -> float:
    estimates = flextip.estimate(flextip.read_recording(folder), window_samples=20)
    found = estimates.f_tip_N[estimates.status == "ok"]
    return float(np.abs(found).max())


def tip(tracker: flextip.Tracker, picture: NDArray[np.uint8]) -> float:
    found = tracker.track(picture, 0)
    return 0.0 if found.p_RE is None else float(found.p_RE[0])


def step(controller: flextip.Controller) -> None:
    wrist = flextip.WristReading(0, [0.0, 0.0, 0.0], position_noise_m=1e-4)
    command = controller.step(0, flextip.Readings(wrist=wrist), [0.1, 0.0, 0.0])
    if command.status == "ok":
        print(command.p_RW_command)


def answers(recording: flextip.Recording) -> dict[str, float]:
    diagnosis = flextip.diagnose(recording, without=["port_motion"])
    for effect, parameters in diagnosis.parameters.items():
        print(effect, {name: p.value for name, p in parameters.items()})
    return diagnosis.probabilities


def runs(scenario: str) -> list[float]:
    simulation = flextip.simulate(scenario, controllers=["rod-track"])
    return [run.max_deviation_m for run in simulation.runs.values()]


def wrong() -> None:
    flextip.estimate("recording")  # WRONG
    flextip.simulate("s.yaml", controllers=["pid"])  # WRONG
    flextip.Rod(0.6)  # WRONG
    flextip.Rod(0.6, 0.3).solve([0, 0, 0], [0.3, 0, 0]).tip.p  # WRONG
    flextip.estimates  # WRONG
