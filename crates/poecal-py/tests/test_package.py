"""What the package itself promises: its names, its documentation, its types, how it starts."""

import doctest
import inspect
import subprocess
import sys
from importlib.resources import files

import poecal
import pytest


def test_version_is_a_text():
    assert isinstance(poecal.version(), str)
    assert poecal.version() == poecal.__version__


def test_public_names_exist_and_are_documented():
    for name in poecal.__all__:
        thing = getattr(poecal, name)
        if name != "__version__":
            assert inspect.getdoc(thing), name


@pytest.mark.parametrize("name", ["Robot", "Measurements", "Calibration", "Simulation", "Prediction", "Findings", "Verdict"])
def test_every_method_is_documented(name):
    of_class = getattr(poecal, name)
    public = [method for method in vars(of_class) if not method.startswith("_")]
    assert public
    assert [method for method in public if not inspect.getdoc(getattr(of_class, method))] == []


def test_options_are_keywords_only():
    for function in [poecal.calibrate, poecal.simulate, poecal.identify, poecal.convert, poecal.offsets, poecal.reproduce]:
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
