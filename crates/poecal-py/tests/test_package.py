"""Properties of the package itself: its names, its documentation, its types, its start."""

import ast
import doctest
import inspect
import os
import re
import subprocess
import sys
from importlib.resources import files

import poecal
import pytest
from robots import elbow


def test_version_is_a_text():
    assert isinstance(poecal.version(), str)
    assert poecal.version() == poecal.__version__


def test_public_names_exist_and_are_documented():
    for name in poecal.__all__:
        thing = getattr(poecal, name)
        if name != "__version__":
            assert inspect.getdoc(thing), name


def functions():
    """Public functions and methods of the stubs, as (name, definition, docstring of the module)."""
    found = {}

    def walk(parent, owner, prefix):
        for node in parent.body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                walk(node, getattr(owner, node.name), f"{node.name}.")
            elif isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
                found.setdefault(prefix + node.name, (node, inspect.getdoc(getattr(owner, node.name)) or ""))

    walk(ast.parse(files("poecal").joinpath("_poecal.pyi").read_text()), poecal._poecal, "")
    return found


FUNCTIONS = functions()


def sections(docstring):
    """The entries of each section of a docstring."""
    parts = re.split(r"^(\w+)\n-+\n", docstring, flags=re.M)
    return {title: re.findall(r"^(?! )(.+)\n    \S", text + "\n", flags=re.M) for title, text in zip(parts[1::2], parts[2::2], strict=True)}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_everything_says_what_it_takes_and_what_it_returns(name):
    node, docstring = FUNCTIONS[name]
    assert docstring.splitlines()[0].endswith("."), docstring
    found = sections(docstring)
    if any(isinstance(it, ast.Name) and it.id == "property" for it in node.decorator_list):
        assert not found
        return
    names = [it.arg for it in [*node.args.args, *node.args.kwonlyargs] if it.arg != "self"]
    documented = [it for entry in found.get("Parameters", []) for it in entry.split(", ")]
    assert sorted(documented) == sorted(names)
    returns_nothing = isinstance(node.returns, ast.Constant) and node.returns.value is None
    assert ("Returns" in found) is not returns_nothing and len(found.get("Returns", ["one"])) == 1
    assert set(found) <= {"Parameters", "Returns", "Raises"}
    for error in found.get("Raises", []):
        assert issubclass(getattr(poecal, error), poecal.Error)


def test_all_functions_are_looked_at():
    assert len(FUNCTIONS) > 100 and "Calibration.predict" in FUNCTIONS and "calibrate" in FUNCTIONS


def test_objects_say_in_one_line_what_they_are():
    made = poecal.simulate(elbow(), kind="point", count=100, held_out_count=5)
    calibration = poecal.calibrate(made.nominal, made.measurements)
    set_of_rows = calibration.accuracy.held_out
    thing = [
        made, made.measurements, elbow(), calibration, calibration.accuracy, set_of_rows, set_of_rows.calibrated, calibration.verdict,
        set_of_rows.calibrated.position_mm, calibration.residuals, calibration.covariance, poecal.check(elbow()),
        calibration.predict([[0.0] * 6], with_uncertainty=True),
    ]  # fmt: skip
    for each in thing:
        print(repr(each))
        assert repr(each).startswith(f"<poecal.{type(each).__name__}") and "\n" not in repr(each) and len(repr(each)) < 250
    error = f"{set_of_rows.calibrated.position_mm.rms:.4f}"
    assert repr(calibration).startswith(f"<poecal.Calibration of elbow: good, calibrated model {error} mm RMS on 30 held-out rows, ")
    assert " mm expected (your model, tool and device located: " in repr(calibration)
    every = poecal.calibrate(made.nominal, made.measurements, held_out=0)
    assert "mm RMS on 100 fitted rows" in repr(every) and "100 fitted rows" in repr(every.accuracy)


def test_options_are_keywords_only():
    for function in [poecal.calibrate, poecal.simulate, poecal.identify, poecal.export, poecal.offsets, poecal.reproduce]:
        parameters = inspect.signature(function).parameters.values()
        with_default = [it for it in parameters if it.default is not inspect.Parameter.empty]
        assert with_default
        assert all(it.kind is inspect.Parameter.KEYWORD_ONLY for it in with_default), function


def test_examples_in_the_documentation_run():
    found = doctest.testmod(poecal)
    assert found.failed == 0 and found.attempted >= 6


def test_types_are_shipped():
    package = files("poecal")
    assert package.joinpath("py.typed").is_file()
    assert "def calibrate(" in package.joinpath("_poecal.pyi").read_text()


def test_importing_does_not_import_numpy():
    code = "import sys, poecal; sys.exit('numpy' in sys.modules or 'json' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code]).returncode == 0


def test_the_package_runs_as_the_program():
    run = subprocess.run([sys.executable, "-m", "poecal", "--version"], capture_output=True, text=True)
    assert (run.returncode, run.stdout) == (0, f"poecal {poecal.__version__}\n")
    run = subprocess.run([sys.executable, "-m", "poecal", "check", "no_such.urdf"], capture_output=True, text=True)
    assert run.returncode == 2
    assert run.stderr.startswith("error: no_such.urdf: ")


def test_a_project_folder_is_made_once(tmp_path):
    model = tmp_path / "robot.toml"
    model.write_text(elbow().to_text("toml"))
    folder = tmp_path / "cell"
    made = poecal.init(model, folder, kind="pose", count=12)
    assert sorted(made) == sorted(path.name for path in folder.iterdir())
    assert len(poecal.read_joints(folder / "joints.csv", poecal.Robot.read(folder / "robot.toml"))) == 12
    with pytest.raises(poecal.FileError):
        poecal.init(model, folder)
    with pytest.raises(poecal.OptionError, match=r"kind: found `points`, .* did you mean `point`\?"):
        poecal.init(model, tmp_path / "other", kind="points")
    assert not (tmp_path / "other").exists()


def test_a_level_of_vector_instructions_that_is_not_here_is_refused():
    code = "import poecal"
    run = subprocess.run([sys.executable, "-c", code], env={**os.environ, "POECAL_SIMD": "avx1024"}, capture_output=True, text=True)
    assert run.returncode == 1
    assert "OptionError: POECAL_SIMD: found `avx1024`, expected one of the levels of this machine (" in run.stderr.splitlines()[-1]
    assert subprocess.run([sys.executable, "-c", code], env={**os.environ, "POECAL_SIMD": "plain"}).returncode == 0
