"""What the package itself promises: its names, its documentation, its types."""

import doctest
from importlib.resources import files

import poecal


def test_version_is_a_text():
    assert isinstance(poecal.version(), str)
    assert poecal.version() == poecal.__version__


def test_public_names_exist_and_are_documented():
    assert all(hasattr(poecal, name) for name in poecal.__all__)
    assert poecal.version.__doc__


def test_examples_in_the_documentation_run():
    assert doctest.testmod(poecal) == (0, 2)


def test_types_are_shipped():
    package = files("poecal")
    assert package.joinpath("py.typed").is_file()
    assert "def version() -> str" in package.joinpath("_poecal.pyi").read_text()
