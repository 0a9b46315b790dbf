"""cmake --install puts the module where Debian's Python finds it."""

import os
import subprocess
import sys


def installed(prefix, stage=None):
    """Installs the component python; returns the folder of the package."""
    environment = os.environ | ({"DESTDIR": str(stage)} if stage else {})
    done = subprocess.run(["cmake", "--install", os.environ["FLEXTIP_BINARY_DIR"], "--component",
                           "python", "--prefix", str(prefix)],
                          capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    places = [line.split(": ", 1)[1] for line in done.stdout.splitlines() if "__init__.py" in line]
    return os.path.dirname(places[0].removeprefix(str(stage or "")))


def imported(path):
    environment = {k: v for k, v in os.environ.items() if k != "PYTHONPATH"} | {"PYTHONPATH": path}
    code = "import flextip; print(flextip.__file__, flextip.Rod(0.6, 0.3))"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                          env=environment)


def test_below_any_prefix(tmp_path):
    package = installed(tmp_path / "prefix")
    assert package == str(tmp_path / "prefix/lib/python3/dist-packages/flextip")
    assert {"__init__.py", "_flextip.pyi", "py.typed"} < set(os.listdir(package))
    done = imported(os.path.dirname(package))
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(package)


def test_where_python_looks(tmp_path):
    """Below /usr and /usr/local (staged, so that nothing is changed there)."""
    import site
    for prefix in ("/usr", "/usr/local"):
        package = installed(prefix, stage=tmp_path / prefix.replace("/", "_"))
        assert os.path.dirname(package) in site.getsitepackages()
        assert package.startswith(prefix + "/lib/python3")
