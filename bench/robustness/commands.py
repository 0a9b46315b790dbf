"""Every command of flextip with a small input."""
import math
import pathlib
import shutil
import subprocess

TABLE = "t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n" + "".join(
    f"{0.02 * i:.2f},{100 + i},{2 * i},{-i},1,0,0,0\n" for i in range(400))
BOARD = [(x, y) for y in range(6) for x in range(9)]


def corners():
    """Returns a corners file: a chessboard seen from twelve places by a camera without distortion."""
    lines = ["#flextip-corners 1", "#board chessboard:9x6:0.025", "#resolution 640 480",
             "#image,id [],x [px],y [px]"]
    for view in range(12):
        # Turned about its x, then its y axis.
        a, b = 0.4 * ((view // 4) - 1.0), 0.4 * ((view % 4) - 1.5)
        for number, (i, j) in enumerate(BOARD):
            x, y = 0.025 * (i - 4), 0.025 * (j - 2.5)
            y, z = y * math.cos(a), y * math.sin(a)
            x, z = x * math.cos(b) + z * math.sin(b), z * math.cos(b) - x * math.sin(b)
            z += 0.4 + 0.02 * view
            lines.append(f"view{view:02},{number},{320 + 600 * x / z:.6f},{240 + 600 * y / z:.6f}")
    return "\n".join(lines) + "\n"


class Commands:
    """Inputs in a folder, and the commands' lines: name -> (arguments, file that ends a result)."""

    def __init__(self, program, root, place):
        self.program, self.place = str(pathlib.Path(program).resolve()), place
        data = pathlib.Path(root).resolve() / "testdata"
        inputs = place / "inputs"
        inputs.mkdir(parents=True)
        (inputs / "robot.csv").write_text(TABLE)
        (inputs / "corners.csv").write_text(corners())
        (inputs / "list.txt").write_text("".join(
            f"{data / 'recordings' / f'sample_{i}'}\n" for i in range(3)))
        sample = shutil.copytree(data / "recordings/sample_0", inputs / "sample_0")
        rendered = data / "recordings/rendered"
        camera = rendered / "cam0/sensor.yaml"
        tracked = inputs / "tracked"
        self.run(["track", rendered, "-o", tracked])
        self.sample, self.inputs = sample, inputs
        folder = "summary.json"
        self.lines = {
            "track": (["track", rendered], folder),
            "estimate": (["estimate", sample], folder),
            "diagnose": (["diagnose", sample], folder),
            "check": (["check", sample], folder),
            "align": (["align", sample], folder),
            "simulate": (["simulate", data / "scenarios/chapter4_up.yaml"], folder),
            "map": (["map", data / "maps/thesis.yaml"], folder),
            "calibrate camera": (["calibrate", "camera", "--corners", inputs / "corners.csv",
                                  "--board", "chessboard:9x6:0.025"],
                                 folder),
            "collar": (["collar"], folder),
            "board": (["board"], folder),
            "import csv": (["import", "csv", inputs / "robot.csv", "--length", "0.6",
                            "--diameter", "2.4mm", "--stiffness", "0.3", "--port", "0.28,0,0",
                            "--set", "wrist0.orientation_noise_rad=0.001"],
                           "recording.yaml"),
            "export csv": (["export", "csv", sample], folder),
            "export tum": (["export", "tum", sample], folder),
            "export mcap": (["export", "mcap", sample], ""),
            "export pictures": (["export", "pictures", tracked], folder),
            "compare": (["compare", tracked, tracked], folder),
            "convert camera": (["convert", "camera", "--to", "opencv", "--drop", "pose", "--drop",
                                "gamma", "--", camera], ""),
            "batch": (["batch", "check", inputs / "list.txt"], folder),
        }

    def words(self, name, out, force=False):
        """Returns the command's line; --force goes before what may end the options."""
        arguments, _ = self.lines[name]
        verbs = 2 if arguments[0] in ("calibrate", "import", "export", "convert", "effect") else 1
        return [self.program, *arguments[:verbs], *(["--force"] if force else []),
                *map(str, arguments[verbs:]), *self.target(name, out)]

    def target(self, name, out):
        return [str(out)] if name == "convert camera" else ["-o", str(out)]

    def run(self, arguments):
        return subprocess.run([self.program, *map(str, arguments)], check=False,
                              capture_output=True, text=True)

    def files(self, name, out):
        """Returns the files of a result with their sizes; None where there is none."""
        if not out.exists():
            return None
        if not self.lines[name][1]:
            return {"": out.stat().st_size}
        return {str(p.relative_to(out)): p.stat().st_size
                for p in sorted(out.rglob("*")) if p.is_file()}
