"""Exceptions and warnings, by the kind of fault."""

from __future__ import annotations

import sys


class Error(Exception):
    """Any error of poecal: one sentence with the place, what was found, what was expected and the remedy.

    ``path``, ``line`` and ``column`` (from 1) state the position in a file, ``row`` (from 0) that in a data frame or an array; each is None if it is
    not known.
    """

    path: str | None
    line: int | None
    column: int | None
    row: int | None

    def __init__(
        self,
        message: str,
        *,
        path: str | None = None,
        line: int | None = None,
        column: int | None = None,
        row: int | None = None,
    ) -> None:
        super().__init__(message)
        self.path, self.line, self.column, self.row = path, line, column, row

    if sys.version_info >= (3, 11):

        def add_note(self, note: str, /) -> None:
            # PyO3 adds one that names the argument, which the sentence already names.
            if not note.startswith("while processing '"):
                super().add_note(note)


class InputError(Error, ValueError):
    """A fault in the input: a file, an array or an option."""


class FileError(InputError):
    """A file could not be read or written."""


class FormatError(InputError):
    """A text that is not of the expected form (XML, TOML, JSON, CSV)."""


class ModelError(InputError):
    """A robot model that is well formed but cannot be used."""


class MeasurementError(InputError):
    """Measurements that are well formed but cannot be used."""


class UnitError(InputError):
    """A unit that is not known, or does not fit its quantity."""


class OptionError(InputError):
    """An argument that is out of range, of the wrong shape, or contradicts another."""


class KeywordError(OptionError, TypeError):
    """A keyword that a function does not have."""


class RowError(OptionError, IndexError):
    """A row that the measurements do not have."""


class PackageError(Error, ImportError):
    """A Python package that is needed here and not installed."""


def missing(package: str) -> PackageError:
    """The error for a package that is not installed."""
    return PackageError(f"found no package `{package}`, expected it to be installed: pip install {package}")


class ProblemError(Error):
    """Too few or unsuitable measurements for the request."""


class ExportError(Error):
    """Written files did not reproduce the fitted model."""


class SolverError(Error):
    """The solver could not produce a usable result."""


class PoecalWarning(UserWarning):
    """Facts that the user should know of a file or a result: the program writes them to standard error."""
