"""The virtual robot of press.yaml and `flextip control --page` that steers it: two processes."""
import pathlib
import re
import signal
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent
CAMERA = ROOT / "testdata/cameras/laparoscope.yaml"
SCENARIO = ROOT / "testdata/scenarios/press.yaml"
SQUARE = ("[{to_m: [0, 0, -0.002]}, {to_m: [0.004, 0, -0.003]}, {to_m: [0.004, 0.006, -0.003]}, "
          "{to_m: [0, 0.003, -0.001]}, {to_m: [0, 0, 0]}]")


def round_and_round(times):
    """Returns the waypoints of so many times around the square."""
    return "[" + ", ".join([SQUARE[1:-1]] * times) + "]"


def session_text(port, camera=True, lockstep=False, rate_hz=120, speed_m_s=0.002,
                 waypoints=SQUARE, kind="rod-track", tip_by_em=False, camera_file=CAMERA):
    """Returns a session on the robot at `port`; the path starts where the tip is. `tip_by_em`: the
    EM sensor near the tip is its measurement, in the place of what sees the tip."""
    def device(name):
        return f"openigtlink: {{port: {port}, device: {name}}}"
    tip = (f"cam0: {{{device('cam0')}, sensor: {camera_file}, "
           f"collar: {ROOT}/testdata/collars/hexagon/sensor.yaml, stale_s: 0.5}}"
           if camera else f"vision0: {{{device('vision0')}}}")
    if tip_by_em:
        tip = ""
    beat = f"\n  lockstep: {{{device('lockstep')}}}" if lockstep else ""
    return f"""format: flextip-session
version: 1
instrument: {{length_m: 0.6, outer_diameter_m: 0.00238, bending_stiffness_Nm2: 0.304}}
port: {{position_m: [0.0, 0.0, 0.17]}}
gravity_m_s2: [0.0, 0.0, -9.81]
sources:
  wrist0: {{{device('PSM1/measured_cp')}, position_noise_m: 0.00005, orientation_noise_rad: 0.0003}}
  em0: {{{device('em0')}, distance_from_tip_m: 0.02, position_noise_m: 0.00013,
        orientation_noise_rad: 0.00056}}
  strain0: {{{device('strain0')}, stations_from_wrist_m: [0.15, 0.5], moment_noise_Nm: 0.0008}}
  {tip}
robot:
  command: {{{device('PSM1/servo_cp')}}}
  state: {{{device('PSM1/operating_state')}}}
  command_state: {{{device('PSM1/state_command')}}}{beat}
controller: {{kind: {kind}, rate_hz: {rate_hz}}}
limits: {{max_step_m: 0.02, max_speed_m_s: 0.1, max_acceleration_m_s2: 10}}
path: {{frame: start, average_s: 0.3, speed_m_s: {speed_m_s}, waypoints: {waypoints}}}
"""


def smaller_camera(folder, width_px):
    """Writes the laparoscope with pictures of this width, and press.yaml with it, into `folder`;
    returns camera and scenario."""
    text = CAMERA.read_text(encoding="utf-8")
    was_px = int(re.search(r"resolution: \[(\d+)", text).group(1))
    scale = width_px / was_px
    numbers = lambda found: [float(v) for v in found.group(2).split(",")]  # noqa: E731
    def resolution(found):
        return found.group(1) + ", ".join(str(round(scale * v)) for v in numbers(found))
    def intrinsics(found):
        fx, fy, cx, cy = numbers(found)  # of pixels with whole numbers at their middles
        return found.group(1) + ", ".join(f"{v:.6f}" for v in (
            scale * fx, scale * fy, scale * (cx + 0.5) - 0.5, scale * (cy + 0.5) - 0.5))
    text = re.sub(r"(resolution: \[)([^]]*)", resolution, text)
    text = re.sub(r"(intrinsics: \[)([^]]*)", intrinsics, text)
    camera, scenario = folder / "camera.yaml", folder / "scenario.yaml"
    camera.write_text(text, encoding="utf-8")
    scenario.write_text(SCENARIO.read_text(encoding="utf-8")
                        .replace("../cameras/laparoscope.yaml", str(camera))
                        .replace("../", f"{SCENARIO.parent}/../"), encoding="utf-8")
    return camera, scenario


def end(program):
    """Ends a program by Ctrl-C; returns its exit code, -SIGKILL where it had to be killed."""
    if program.poll() is None:
        program.send_signal(signal.SIGINT)
    try:
        program.communicate(timeout=60)
    except subprocess.TimeoutExpired:
        program.kill()
        program.communicate(timeout=60)
    return program.returncode


class LiveRun:
    """Use it in a `with` block, which ends both programs. `address` is the page's, with its token;
    empty without a page. `recording` is the folder that control writes. `picture_width_px`: of the
    laparoscope; empty: its own. `served`: where the robot writes its own recording; empty: nowhere.
    """

    def __init__(self, program, folder, page=True, options=(), picture_width_px=None, served=None,
                 **session):
        self.program, self.folder, self.page = str(program), pathlib.Path(folder), page
        self.options, self.session, self.served = options, session, served
        self.recording = self.folder / "run"
        self.scenario = SCENARIO
        if picture_width_px:
            self.session["camera_file"], self.scenario = smaller_camera(self.folder, picture_width_px)
        self.address, self.programs, self.said = "", [], ""

    def __enter__(self):
        try:
            self._begin()
        except BaseException:
            self.__exit__()
            raise
        return self

    def _begin(self):
        camera, lockstep = (self.session.get(key, default)
                            for key, default in (("camera", True), ("lockstep", False)))
        self.robot = self._start("simulate", self.scenario, "--serve", "0",
                                 *["--render"] * camera, *["--lockstep"] * lockstep,
                                 *(["-o", self.served] if self.served else []))
        port = self._wait_for(self.robot, r"serving on 127\.0\.0\.1:(\d+)")
        file = self.folder / "session.yaml"
        file.write_text(session_text(port, **self.session), encoding="utf-8")
        self.control = self._start("control", *["--page"] * self.page, file, "-o", self.recording,
                                   *["--page-port", "0"] * self.page, *self.options)
        if self.page:
            self.address = self._wait_for(self.control, r"page: (\S+)")

    def __exit__(self, *_):
        for program in reversed(self.programs):
            end(program)

    def wait(self, seconds):
        """Waits until control has ended; returns its exit code. `said` is what it printed."""
        self.said += self.control.communicate(timeout=seconds)[0]
        return self.control.returncode

    def _start(self, *arguments):
        program = subprocess.Popen([self.program, *map(str, arguments)], stdout=subprocess.PIPE,
                                   text=True)
        self.programs.append(program)
        return program

    @staticmethod
    def _wait_for(program, pattern):
        """Returns the first group of the first line that fits."""
        for line in program.stdout:
            found = re.search(pattern, line)
            if found:
                return found.group(1)
        raise RuntimeError(f"{program.args[1]} ended without saying {pattern}")
