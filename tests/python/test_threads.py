"""Long calls let other threads run, hear Ctrl-C, and share objects safely."""

import signal
import threading
import time

import numpy as np
import pytest
from conftest import RECORDINGS, TESTDATA

import flextip

RECORDING = flextip.read_recording(RECORDINGS / "sample_2")


class Counter(threading.Thread):
    """Counts every millisecond that it gets to run."""

    def __init__(self):
        super().__init__(daemon=True)
        self.count, self.stopped = 0, False

    def run(self):
        while not self.stopped:
            time.sleep(0.001)
            self.count += 1


PRESS = TESTDATA / "scenarios/press.yaml"
# Reading takes a few milliseconds: too short to be seen by a counter.
CALLS = {
    "estimate": lambda: flextip.estimate(RECORDING),
    "track": lambda: flextip.track(RECORDINGS / "rendered"),
    "diagnose": lambda: flextip.diagnose(RECORDING, closed_loop=False),
    "simulate": lambda: flextip.simulate(PRESS, controllers=["rod-track"]),
}


def counted_during(call):
    """Returns how often another thread ran during a call, and the milliseconds it took."""
    counter = Counter()
    counter.start()
    try:
        before, start = counter.count, time.monotonic()
        call()
        return counter.count - before, 1e3 * (time.monotonic() - start)
    finally:
        counter.stopped = True


@pytest.mark.parametrize("call", CALLS.values(), ids=CALLS.keys())
def test_other_threads_run(call):
    counted, took_ms = counted_during(call)
    assert took_ms > 5
    assert counted > max(2, 0.02 * took_ms)  # a loaded machine wakes the counter late


def test_a_call_that_holds_the_lock_is_seen():
    tries = [counted_during(lambda: sum(range(20_000_000))) for _ in range(5)]
    counted, took_ms = min(tries)  # a loaded machine may stop between the two looks at the counter
    assert took_ms > 50 and counted <= 2


class Stop(Exception):
    pass


LONG_CALLS = {
    "estimate": lambda: flextip.estimate(RECORDING, window_samples=10),
    "simulate": lambda: flextip.simulate(PRESS),
}


@pytest.mark.parametrize("call", LONG_CALLS.values(), ids=LONG_CALLS.keys())
def test_a_signal_ends_a_long_call(call):
    start = time.monotonic()
    call()
    whole_s = time.monotonic() - start

    def stop(number, frame):
        raise Stop()
    previous = signal.signal(signal.SIGALRM, stop)
    taken_s = []
    try:
        for _ in range(5):  # the least counts: a loaded machine wakes late
            signal.setitimer(signal.ITIMER_REAL, 0.02)
            start = time.monotonic()
            with pytest.raises(Stop):
                call()
            taken_s.append(time.monotonic() - start)
        assert min(taken_s) < 0.6 * whole_s
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, previous)


def test_an_error_in_on_frame_comes_back():
    from conftest import SOURCE

    def fail(name, t_ns, image):
        raise Stop(name)
    with pytest.raises(Stop, match="rod-track"):
        flextip.simulate(SOURCE / "examples/clip.yaml", render=True, on_frame=fail)


def test_threads_take_turns():
    rod = flextip.Rod(0.6, 0.304)
    forces = [np.array([0.0, 0.1 * i, -1.0]) for i in range(4)]
    expected = [flextip.Rod(0.6, 0.304).solve([0, 0, 0], [0.28, 0, 0], f).tip.p for f in forces]
    wrong = []

    def work(i):
        for _ in range(200):
            tip = rod.solve([0, 0, 0], [0.28, 0, 0], forces[i]).tip.p
            if not np.allclose(tip, expected[i], atol=1e-8):
                wrong.append(i)
    threads = [threading.Thread(target=work, args=(i,)) for i in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_a_recording_may_change_while_it_is_estimated():
    recording = RECORDING.copy()
    results = []
    thread = threading.Thread(target=lambda: results.append(flextip.estimate(recording)))
    thread.start()
    time.sleep(0.02)
    for _ in range(50):
        recording.em0 = None
        recording.em0 = RECORDING.em0
    thread.join()
    assert len(results[0]) == len(flextip.estimate(RECORDING))
