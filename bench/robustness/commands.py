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


def write_arm(folder, rows=150):
    """Writes a recording of an arm of two joints: commands, late encoders, a tracker."""
    def write(name, text):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)

    def table(name, columns, row):
        lines = [",".join(["#timestamp [ns]", *columns])]
        lines += [",".join([str(20_000_000 * i), *(f"{v:.6f}" for v in row(0.02 * i))])
                  for i in range(1, rows + 1)]
        write(f"{name}/data.csv", "\n".join(lines) + "\n")

    def joints(t):
        return 0.6 * math.sin(1.3 * t), 0.5 * math.cos(2.1 * t)

    def place(q):
        a, b = q[0], q[0] + q[1]
        return (0.3 * math.cos(a) + 0.2 * math.cos(b), 0.3 * math.sin(a) + 0.2 * math.sin(b), 0.0,
                math.cos(b / 2), 0.0, 0.0, math.sin(b / 2))

    write("recording.yaml", "format: flextip-recording\nversion: 1\ngravity_m_s2: [0, 0, -9.81]\n")
    joint = "  - {type: revolute, a_m: %s, alpha_rad: 0, d_m: 0, theta_rad: 0}\n"
    write("arm.yaml", "format: flextip-arm\nversion: 1\nconvention: dh\njoints:\n"
          + joint % 0.3 + joint % 0.2)
    for name, late in (("joints0", 0.04), ("joints_command0", 0.0)):
        write(f"{name}/sensor.yaml", "rate_hz: 50\njoint_noise: [1e-4, 1e-4]\n")
        table(name, ["q1 [rad]", "q2 [rad]"], lambda t, late=late: joints(t - late))
    write("pose0/sensor.yaml", "rate_hz: 50\nposition_noise_m: 2e-4\norientation_noise_rad: 1e-3\n")
    table("pose0", ["p_RK_x [m]", "p_RK_y [m]", "p_RK_z [m]", "q_RK_w []", "q_RK_x []", "q_RK_y []",
                    "q_RK_z []"], lambda t: place(joints(t - 0.04)))
    return folder


def cut(recording, begin_s, end_s):
    """Cuts every table of a recording to this time since its begin. Returns the recording."""
    tables = {f: f.read_text().splitlines(keepends=True) for f in recording.rglob("data.csv")}

    def stamp(line):
        return int(line.split(",", 1)[0])
    start = min(stamp(lines[1]) for lines in tables.values())
    for file, lines in tables.items():
        file.write_text("".join([lines[0], *(line for line in lines[1:] if begin_s <= (
            stamp(line) - start) / 1e9 < end_s)]))
    return recording


# What a diagnosis found without a name: the input of `effect new`.
TERM = """format: flextip-model
version: 1
centre_m: [0.26, 0.01, -0.02]
start_ns: 1700000000000000000
effects: {}
discovered:
  - channel: strain0_moment_Nm
    shape: band
    variable: own_value
    at: [0.0747]
    amplitude: [-1.0, -1.0, 0, 0]
    text: "the strain reading goes off"
"""


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
        short = cut(shutil.copytree(sample, inputs / "short"), 0.0, 3.0)
        later = cut(shutil.copytree(sample, inputs / "later"), 6.0, 9.0)
        arm = write_arm(inputs / "arm")
        (inputs / "term.yaml").write_text(TERM)
        rendered = data / "recordings/rendered"
        camera = rendered / "cam0/sensor.yaml"
        tracked = inputs / "tracked"
        found, arm_found, simulated = inputs / "found", inputs / "arm_found", inputs / "simulated"
        self.run(["track", rendered, "-o", tracked])
        self.run(["diagnose", short, "--no-closed-loop", "-o", found])
        self.run(["diagnose", arm, "-o", arm_found])
        self.run(["simulate", data / "scenarios/chapter4_up.yaml", "-o", simulated])
        self.inputs = inputs
        self.simulated = next(simulated.rglob("recording.yaml")).parent
        folder = "summary.json"
        self.lines = {
            "track": (["track", rendered], folder),
            "estimate": (["estimate", sample], folder),
            "diagnose": (["diagnose", short], folder),
            "diagnose several": (["diagnose", short, later, "--no-closed-loop"], folder),
            "diagnose motion": (["diagnose", short, "--no-closed-loop", "--plan-motion",
                                 "--plan-seconds", "2"], folder),
            "diagnose arm": (["diagnose", arm], folder),
            "predict": (["predict", short, "--model", found / "model.yaml"], folder),
            "predict arm": (["predict", arm, "--model", arm_found / "model.yaml"], folder),
            "effect new": (["effect", "new", inputs / "term.yaml"], ""),
            "detect": (["detect", *sorted((rendered / "cam0/data").glob("*.png"))[:2]], folder),
            "replay": (["replay", self.simulated], folder),
            "calibrate budget": (["calibrate", "budget", rendered, "--tip-force", "0,0.2,0",
                                  "--frames", "5"], folder),
            "shape": (["shape", "--length", "0.6", "--stiffness", "0.304", "--wrist", "0,0,0",
                       "--port", "0.28,0,0", "--tip-force", "0,0,-2"], folder),
            "check": (["check", sample], folder),
            "align": (["align", sample], folder),
            "simulate": (["simulate", data / "scenarios/chapter4_up.yaml"], folder),
            "map": (["map", data / "maps/thesis.yaml"], folder),
            "calibrate camera": (["calibrate", "camera", "--corners", inputs / "corners.csv",
                                  "--board", "chessboard:9x6:0.025"],
                                 folder),
            "collar": (["collar"], folder),
            "board": (["board"], folder),
            "calibrate strain": (["calibrate", "strain", sample], folder),
            "calibrate stiffness": (["calibrate", "stiffness", sample], folder),
            "calibrate tip": (["calibrate", "tip", sample], folder),
            "calibrate em": (["calibrate", "em", sample], folder),
            "reproduce": (["reproduce", "3", "--quick"], folder),
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

    def tables(self, name):
        """Returns the tables of the command's inputs that are the trial's own copies."""
        folders = [a for a in self.lines[name][0]
                   if isinstance(a, pathlib.Path) and a.is_relative_to(self.inputs)]
        return [f for folder in folders for f in sorted(folder.rglob("data.csv"))]

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
