"""Every public name has a docstring and types, and the types are those of the module."""

import ast
import inspect
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from conftest import SOURCE

import flextip
import flextip._flextip as compiled

HERE = Path(__file__).parent
STUB = ast.parse((SOURCE / "python/flextip/_flextip.pyi").read_text())
PUBLIC = [name for name in flextip.__all__ if name != "__version__"]
CLASSES = [name for name in PUBLIC if inspect.isclass(getattr(flextip, name))]
FUNCTIONS = [name for name in PUBLIC if name not in CLASSES]


def members(cls):
    """The names that a class of the module adds itself."""
    hidden = {"__init__", "__new__", "__module__", "__doc__", "__repr__", "__weakref__"}
    return {name for name in vars(cls) if not name.startswith("_pybind") and name not in hidden}


def without_signature(doc):
    """A docstring's own words: pybind11 puts the signature in the first line."""
    return "\n".join(line for line in (doc or "").splitlines()
                     if not re.match(r"^\s*\w+\(.*\) -> ", line)).strip()


def test_version():
    cmake = (SOURCE / "CMakeLists.txt").read_text()
    assert f"project(flextip VERSION {flextip.__version__} " in cmake


def test_all_that_is_compiled_is_public():
    made = {name for name in vars(compiled) if not name.startswith("_")}
    assert made == set(PUBLIC)


def test_every_name_has_a_docstring():
    lacking = [name for name in PUBLIC if not without_signature(getattr(flextip, name).__doc__)]
    for name in CLASSES:
        cls = getattr(flextip, name)
        for member in members(cls) - {"__len__", "__getitem__"}:
            if not without_signature(getattr(vars(cls)[member], "__doc__", "")):
                lacking.append(f"{name}.{member}")
    assert not lacking


def test_arrays_state_shape_and_unit():
    """What is typed as an array says its shape; a name with a unit says no other."""
    lacking = []
    for node in STUB.body:
        if not isinstance(node, ast.ClassDef):
            continue
        for function in node.body:
            if not isinstance(function, ast.FunctionDef) or function.name.startswith("__"):
                continue
            returns = ast.unparse(function.returns)
            is_array = any(kind in returns for kind in ("_Floats", "_Times", "_Texts"))
            doc = getattr(getattr(flextip, node.name), function.name).__doc__
            if is_array and not re.search(r"\((N|M|\d)[^)]*,[^)]*\)", doc):
                lacking.append(f"{node.name}.{function.name}: {doc}")
    assert not lacking


def stub_classes():
    return {node.name: node for node in STUB.body if isinstance(node, ast.ClassDef)}


def stub_functions(body):
    return {node.name: node for node in body if isinstance(node, ast.FunctionDef)}


def stub_members(node):
    names = {f.name for f in node.body if isinstance(f, ast.FunctionDef)}
    names |= {f.target.id for f in node.body if isinstance(f, ast.AnnAssign)}
    return names - {"__init__"}


def parameters_of_stub(function):
    a = function.args
    names = [arg.arg for arg in a.args]
    optional = set(names[len(names) - len(a.defaults):])
    optional |= {arg.arg for arg, d in zip(a.kwonlyargs, a.kw_defaults) if d is not None}
    names += (["*"] if a.kwonlyargs else []) + [arg.arg for arg in a.kwonlyargs]
    return [(name, name in optional) for name in names if name != "self"]


def parameters_of(function):
    """Reads the signature in pybind11's docstring: names, and which have a default."""
    text = function.__doc__.splitlines()[0]
    text = text[text.index("(") + 1:text.rindex(") ->")]
    parts, depth, part = [], 0, ""
    for letter in text:
        depth += (letter in "([{<") - (letter in ")]}>")
        if letter == "," and depth == 0:
            parts.append(part)
            part = ""
        else:
            part += letter
    parts.append(part)
    found = [(p.split(":")[0].strip(), "=" in p) for p in parts if p.strip()]
    return [(name, optional) for name, optional in found if name != "self"]


@pytest.mark.parametrize("name", CLASSES)
def test_a_class_has_its_types(name):
    cls, node = getattr(flextip, name), stub_classes()[name]
    if issubclass(cls, Exception):
        return
    assert stub_members(node) == members(cls)
    functions = stub_functions(node.body)
    for member in {"__init__"} | members(cls):
        attribute = vars(cls).get(member)
        if isinstance(attribute, property) or member in ("__len__", "__getitem__"):
            continue
        if member == "__init__" and member not in functions:
            with pytest.raises(TypeError, match="No constructor"):
                cls()
            continue
        assert parameters_of(attribute) == parameters_of_stub(functions[member]), member


@pytest.mark.parametrize("name", CLASSES)
def test_only_what_may_be_set_is_typed_so(name):
    node = stub_classes()[name]
    settable = {f.target.id for f in node.body if isinstance(f, ast.AnnAssign)}
    settable |= {f.name for f in node.body if isinstance(f, ast.FunctionDef)
                 and any("setter" in ast.unparse(d) for d in f.decorator_list)}
    cls = getattr(flextip, name)
    assert settable == {m for m, a in vars(cls).items() if isinstance(a, property) and a.fset}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_function_has_its_types(name):
    stub = stub_functions(STUB.body)[name]
    assert parameters_of(getattr(flextip, name)) == parameters_of_stub(stub)


def mypy(*arguments, cache):
    pytest.importorskip("mypy")
    environment = os.environ | {"MYPYPATH": str(SOURCE / "python")}
    return subprocess.run([sys.executable, "-m", *arguments], capture_output=True, text=True,
                          env=environment, cwd=cache)  # where it leaves its cache


def test_stubtest(tmp_path):
    """Nothing is found but what all classes of pybind11 have: its metaclass, and no signature."""
    done = mypy("mypy.stubtest", "flextip._flextip", "--concise", cache=tmp_path)
    usual = ("metaclass differs", 'is inconsistent, stub does not have *args argument "args"')
    assert done.stdout.count(usual[0]) >= len(CLASSES) - 3, done.stderr
    found = [line for line in done.stdout.splitlines() if not line.endswith(usual)]
    assert not found


def test_a_users_code_passes_mypy_and_wrong_code_does_not(tmp_path):
    file = HERE / "typed_use.py"
    done = mypy("mypy", "--strict", "--no-error-summary", str(file), cache=tmp_path)
    lines = file.read_text().splitlines()
    expected = {i for i, line in enumerate(lines, 1) if line.endswith("# WRONG")}
    found = {int(number) for number in re.findall(r"typed_use\.py:(\d+): error", done.stdout)}
    assert found == expected and len(expected) == 5, done.stdout + done.stderr


def test_results_say_what_they_are():
    recording = flextip.read_recording(SOURCE / "testdata/recordings/sample_0")
    assert repr(recording) == "<Recording of wrist0, em0, strain0, load0, cam0, vision0>"
    estimates = flextip.estimate(recording)
    assert repr(estimates) == f"<Estimates of 1200 samples, good: {estimates.judgement.says}>"
    assert repr(estimates.judgement).startswith("<Judgement good: ")
