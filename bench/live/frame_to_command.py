#!/usr/bin/env python3
"""Says how long a picture takes from its arrival to the command that it changes.

    frame_to_command.py --program build/ci/apps/flextip [--seconds 20] [--real-time RATE_HZ]
                        [--camera WIDTH_PX] [--work FOLDER]

The virtual robot's laparoscope, 1280 pixels wide, 30 pictures a second, in lockstep: robot and
renderer wait meanwhile. --real-time: the cycle does not wait for pictures, and a picture waits for
the next cycle; the renderer takes its share of the processors.
"""
import argparse
import csv
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
from live_run import LiveRun, round_and_round  # noqa: E402


def times_ms(recording):
    """Returns the milliseconds of each picture that a command was sent for."""
    found, last = [], None
    with open(recording / "session0/cycles.csv", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            taken, sent = row["vision0 t [ns]"], row["sent [ns]"]
            if not taken or taken == last:
                continue
            last = taken
            if sent and int(sent) > 0:
                found.append(1e-6 * (int(sent) - int(row["vision0 arrived [ns]"])))
    return sorted(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", required=True)
    parser.add_argument("--seconds", type=int, default=20)
    parser.add_argument("--real-time", type=float, metavar="RATE_HZ")
    parser.add_argument("--camera", type=int, metavar="WIDTH_PX")
    parser.add_argument("--work", type=pathlib.Path, help="keep the recording here")
    options = parser.parse_args()
    session = {"lockstep": options.real_time is None, "rate_hz": options.real_time or 30,
               "waypoints": round_and_round(options.seconds // 10 + 1)}
    with tempfile.TemporaryDirectory() as folder:
        work = options.work or pathlib.Path(folder)
        work.mkdir(parents=True, exist_ok=True)
        with LiveRun(options.program, work, page=False, picture_width_px=options.camera,
                     options=["--duration", str(options.seconds)], **session) as run:
            run.wait(60 + 20 * options.seconds)
            recording = run.recording
        ms = times_ms(recording)
    if not ms:
        raise SystemExit("no picture came with a command")
    at = [ms[min(len(ms) - 1, int(part * len(ms)))] for part in (0.5, 0.99, 1)]
    print(f"{len(ms)} pictures; arrived to command sent: p50 {at[0]:.2f}, p99 {at[1]:.2f}, "
          f"worst {at[2]:.2f} ms")


if __name__ == "__main__":
    main()
