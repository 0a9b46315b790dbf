#!/usr/bin/python3
"""mrcal's figures on the corners that flextip_calibration_compare wrote.

Usage: mrcal.py FOLDER [--models LENSMODEL_...,...]

FOLDER holds set.json (images, board, image size, working distance) and corners.vnl; mrcal.json is
written there, one row a model. Needs Debian's python3-mrcal and mrcal; run with /usr/bin/python3.
"""
import argparse
import json
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

import mrcal
import numpy as np
import scipy.optimize

SPLINED = "LENSMODEL_SPLINED_STEREOGRAPHIC_order=3_Nx={}_Ny={}_fov_x_deg={}"


def read_corners(folder, board):
    """Corners by image, shape (rows, columns, 2); images without a board are left out. The images
    are numbered, as mrcal orders them by the numbers in their names."""
    corners, numbers = {}, {}
    for line in (folder / "corners.vnl").read_text().splitlines():
        if line.startswith("#"):
            continue
        name, x, y, _ = line.split()
        if x != "-":
            number = numbers.setdefault(name, f"{len(numbers):04}.png")
            corners.setdefault(number, []).append((float(x), float(y)))
    shape = (board["rows"], board["columns"], 2)
    return {n: np.array(c).reshape(shape) for n, c in corners.items()}


def write_corners(file, corners):
    with open(file, "w") as out:
        out.write("# filename x y level\n")
        for name, c in corners.items():
            for x, y in c.reshape(-1, 2):
                out.write(f"{name} {x} {y} 0\n")


def child_seconds():
    """Of the processor, all threads, with what Python takes to start."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def calibrate(head, corners, model):
    """Runs mrcal's own tool on these corners: the model it writes, and the seconds it took."""
    board = head["board"]
    with tempfile.TemporaryDirectory() as out:
        cache = Path(out) / "corners.vnl"
        write_corners(cache, corners)
        start = child_seconds()
        subprocess.run(
            ["mrcal-calibrate-cameras", "--lensmodel", model, "--focal", str(head["focal_px"]),
             "--imagersize", str(head["width_px"]), str(head["height_px"]),
             "--object-spacing", str(board["square_m"]),
             "--object-width-n", str(board["columns"]), "--object-height-n", str(board["rows"]),
             "--corners-cache", str(cache), "--outdir", out, "*"],
            check=True, capture_output=True, cwd=out)
        seconds = child_seconds() - start
        return mrcal.cameramodel(str(Path(out) / "camera-0.cameramodel")), seconds


def board_points(head, warp):
    b = head["board"]
    return mrcal.ref_calibration_object(b["columns"], b["rows"], b["square_m"],
                                        calobject_warp=warp).reshape(-1, 3)


def pose_errors(model, points, seen, start):
    """Squared distances of a view's corners after its pose has been fitted, everything else kept."""
    def residuals(rt):
        at = mrcal.transform_point_rt(rt, points)
        return (mrcal.project(at, *model.intrinsics()) - seen.reshape(-1, 2)).ravel()
    fit = scipy.optimize.least_squares(residuals, start, x_scale=[1, 1, 1, 0.1, 0.1, 0.1])
    return np.sum(fit.fun.reshape(-1, 2) ** 2, axis=1)


def frames_by_name(model, names):
    return dict(zip(names, model.optimization_inputs()["frames_rt_toref"]))


def heldout_rms(head, corners, model_name, start):
    """Both halves (every other view) by the other: root of the mean squared distance."""
    names = list(corners)
    squares = []
    for half in (0, 1):
        model, _ = calibrate(head, {n: corners[n] for n in names[half::2]}, model_name)
        points = board_points(head, model.optimization_inputs()["calobject_warp"])
        for n in names[1 - half::2]:
            squares.append(pose_errors(model, points, corners[n], start[n]))
    return float(np.sqrt(np.mean(np.concatenate(squares))))


def uncertainty(head, model):
    """Worst direction's standard deviation (px) over a grid: centre, mean, largest, at infinity."""
    x, y = np.meshgrid(np.linspace(0, head["width_px"] - 1, 13),
                       np.linspace(0, head["height_px"] - 1, 10))
    rays = mrcal.unproject(np.stack((x, y), -1), *model.intrinsics(), normalize=True)
    result = {}
    for name, z, infinity in (("near", head["working_distance_m"], False), ("infinity", 1, True)):
        at = rays / rays[..., 2:] * z
        sd = mrcal.projection_uncertainty(at, model=model, atinfinity=infinity,
                                          what="worstdirection-stdev")
        result[f"sd_{name}_mean_px"] = float(np.nanmean(sd))
        result[f"sd_{name}_max_px"] = float(np.nanmax(sd))
        ray = mrcal.unproject(np.array([head["width_px"] / 2, head["height_px"] / 2]),
                              *model.intrinsics(), normalize=True)
        result[f"sd_{name}_centre_px"] = float(mrcal.projection_uncertainty(
            ray / ray[2] * z, model=model, atinfinity=infinity, what="worstdirection-stdev"))
    return result


def row(head, corners, name):
    model, seconds = calibrate(head, corners, name)
    inputs = model.optimization_inputs()
    residuals = mrcal.residuals_chessboard(inputs).reshape(-1, 2)
    weights = inputs["observations_board"][..., 2]
    start = frames_by_name(model, corners)
    return {
        "peer": "mrcal", "model": name.replace("LENSMODEL_", ""),
        "views": len(corners), "outliers": int(np.sum(weights <= 0)),
        "rms_px": float(np.sqrt(np.mean(np.sum(residuals ** 2, axis=1)))),
        "noise_px": float(np.std(residuals)),
        "heldout_rms_px": heldout_rms(head, corners, name, start),
        "fu_px": float(model.intrinsics()[1][0]),
        "seconds": seconds,
        **uncertainty(head, model),
    }


def stereo(left, right, model):
    """Both cameras together: RMS, baseline and its standard deviation (from the joint solve)."""
    head = json.loads((left / "set.json").read_text())
    board = head["board"]
    corners = {f"{eye}{n}": c for eye, folder in (("left", left), ("right", right))
               for n, c in read_corners(folder, board).items()}
    with tempfile.TemporaryDirectory() as out:
        cache = Path(out) / "corners.vnl"
        write_corners(cache, corners)
        start = child_seconds()
        subprocess.run(
            ["mrcal-calibrate-cameras", "--lensmodel", model, "--focal", str(head["focal_px"]),
             "--imagersize", str(head["width_px"]), str(head["height_px"]),
             "--object-spacing", str(board["square_m"]),
             "--object-width-n", str(board["columns"]), "--object-height-n", str(board["rows"]),
             "--corners-cache", str(cache), "--outdir", out, "left*", "right*"],
            check=True, capture_output=True, cwd=out)
        seconds = child_seconds() - start
        models = [mrcal.cameramodel(f"{out}/camera-{i}.cameramodel") for i in (0, 1)]
    inputs = models[0].optimization_inputs()
    residuals = mrcal.residuals_chessboard(inputs).reshape(-1, 2)
    T = mrcal.compose_Rt(models[0].extrinsics_Rt_fromref(), models[1].extrinsics_Rt_toref())
    return {"peer": "mrcal", "model": model.replace("LENSMODEL_", ""),
            "outliers": int(np.sum(inputs["observations_board"][..., 2] <= 0)),
            "rms_px": float(np.sqrt(np.mean(np.sum(residuals ** 2, axis=1)))),
            "baseline_mm": float(1e3 * np.linalg.norm(T[3])),
            "fu_px": [float(m.intrinsics()[1][0]) for m in models],
            "seconds": seconds}


def spread(folder, runs):
    """Errors of calibrations from other noise in units of what mrcal says of itself."""
    truth = json.loads((folder / "truth.json").read_text())
    T_CB = np.array(truth["T_CB"]).reshape(-1, 4, 4)
    nees = []
    for run in sorted((folder / "runs").iterdir())[:runs]:
        head = json.loads((run / "set.json").read_text())
        model, _ = calibrate(head, read_corners(run, head["board"]), "LENSMODEL_OPENCV5")
        inputs = model.optimization_inputs()
        frames = mrcal.Rt_from_rt(inputs["frames_rt_toref"])
        for place in truth["places"]:
            x_C = np.array(place["x_C"])
            x_B = np.array([np.linalg.inv(T) @ [*x_C, 1.0] for T in T_CB])[:, :3]
            mean = np.mean([mrcal.transform_point_Rt(f, x) for f, x in zip(frames, x_B)], axis=0)
            error = mrcal.project(mean, *model.intrinsics()) - np.array(place["px"])
            covariance = mrcal.projection_uncertainty(x_C, model=model, what="covariance")
            nees.append(float(error @ np.linalg.solve(covariance, error)))
    result = {"mrcal": {"runs": len(nees) // len(truth["places"]),
                        "projection_nees_of_2": float(np.mean(nees))}}
    (folder / "mrcal_spread.json").write_text(json.dumps(result, indent=1))
    print(json.dumps(result))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--models", default="OPENCV5,OPENCV8,OPENCV12,SPLINED")
    parser.add_argument("--spread", type=int, metavar="RUNS",
                        help="FOLDER is of flextip_calibration_spread: so many of its runs")
    parser.add_argument("--stereo", type=Path, metavar="RIGHT",
                        help="FOLDER is of the left camera, this one of the right")
    arguments = parser.parse_args()
    if arguments.stereo:
        for name in arguments.models.split(","):
            if name != "SPLINED":
                print(json.dumps(stereo(arguments.folder, arguments.stereo, "LENSMODEL_" + name)))
        return
    if arguments.spread:
        spread(arguments.folder, arguments.spread)
        return
    head = json.loads((arguments.folder / "set.json").read_text())
    corners = read_corners(arguments.folder, head["board"])
    rows = []
    for name in arguments.models.split(","):
        full = "LENSMODEL_" + name
        if name == "SPLINED":
            fov = round(1.2 * np.degrees(2 * np.arctan(head["width_px"] / 2 / head["focal_px"])))
            full = SPLINED.format(12, 9, fov)
        try:
            rows.append(row(head, corners, full))
        except subprocess.CalledProcessError as error:
            rows.append({"peer": "mrcal", "model": name,
                         "failed": error.stderr.decode().strip().splitlines()[-1]})
        print(json.dumps(rows[-1]), file=sys.stderr)
    (arguments.folder / "mrcal.json").write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
