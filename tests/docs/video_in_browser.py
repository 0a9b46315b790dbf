#!/usr/bin/env python3
"""Plays the overlay video on the page of flextip track:

    video_in_browser.py --source ROOT --program build/ci/apps/flextip --work FOLDER
"""
import argparse
import pathlib
import shutil
import subprocess
import sys

from browser import SKIPPED, chromium, run_checks

SCRIPT = """
const page = await look("/track/report.html", 1200);
const video = page.querySelector("video[controls]");
if (!video) return { error: "the page has no video" };
const loaded = await until(() => video.readyState >= 2 || video.error, 20);
if (video.error) return { error: "the video does not load: " + video.error.message };
if (!loaded) { video.preload = "auto"; await until(() => video.readyState >= 2, 20); }
await video.play();
await until(() => video.currentTime > 0, 20);
return { width: video.videoWidth, played: video.currentTime };
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    for name in ("source", "program", "work"):
        parser.add_argument(f"--{name}", type=pathlib.Path, required=True)
    options = parser.parse_args()
    if not chromium():
        print("skipped: no chromium")
        return SKIPPED
    recording = options.source / "testdata/recordings/rendered"
    subprocess.run([options.program, "--quiet", "track", recording, "--overlay", "--force", "-o",
                    options.work / "track"], check=True)
    result = run_checks(options.work, SCRIPT, 60)
    print(result)
    shutil.rmtree(options.work)
    return 0 if result.get("width") == 1280 and result.get("played", 0) > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
