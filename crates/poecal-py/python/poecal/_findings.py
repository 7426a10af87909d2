"""Common parts of all results: the answer in a sentence, a table, and the program's output with `--json`."""

from __future__ import annotations

import importlib
import io
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeVar, cast

from ._errors import missing

if TYPE_CHECKING:
    # Of a private name, since pandas has no types, so that stubtest would look for it where this runs.
    import pandas as _pandas  # type: ignore[import-untyped, import-not-found, unused-ignore]

T = TypeVar("T")


def imported(package: str) -> Any:
    """A package that may not be installed."""
    try:
        return importlib.import_module(package)
    except ModuleNotFoundError as error:
        raise missing(package) from error


def table(text: str) -> _pandas.DataFrame:
    """A table of comma-separated values, with comments, as a data frame."""
    return imported("pandas").read_csv(io.StringIO(text), comment="#")


class Findings(Mapping[str, Any]):
    """A result: `str` is the program's table, `repr` the answer, and `found["key"]` a part of the program's output with `--json`.

    Its kinds have the important numbers as attributes, with units in their names.
    """

    __slots__ = ("_answer", "_found", "_json", "_text", "_warnings")

    def __init__(self, text: str, answer: str, json: str, warnings: Sequence[str] = ()) -> None:
        self._text, self._answer, self._json, self._warnings = text, answer, json, list(warnings)
        self._found: dict[str, Any] | None = None

    @property
    def answer(self) -> str:
        """The answer in a sentence."""
        return self._answer

    @property
    def warnings(self) -> list[str]:
        """Warnings, a sentence each."""
        return list(self._warnings)

    def to_dict(self) -> dict[str, Any]:
        """The result as dicts and lists: the program's output with `--json`.

        Returns
        -------
        dict
            The result.
        """
        # Loaded on demand, as by the rest of the package.
        import json

        return cast("dict[str, Any]", json.loads(self._json))

    def to_json(self) -> str:
        """The result as JSON.

        Returns
        -------
        str
            The text.
        """
        return self._json

    def to_dataframe(self) -> _pandas.DataFrame:
        """The result as a data frame of pandas, which has to be installed; each kind of result states its rows.

        Returns
        -------
        pandas.DataFrame
            The rows; a part of a part is named with a point, as `change.offset_deg`.
        """
        return imported("pandas").json_normalize(self._rows())

    def _rows(self) -> list[dict[str, Any]]:
        """Rows of the data frame: by default the whole result as one row."""
        return [self.to_dict()]

    def _at(self, kind: type[T], *keys: str) -> T:
        """The part at some keys, of a known type."""
        return cast("T", self._maybe(kind, *keys))

    def _maybe(self, kind: type[T], *keys: str) -> T | None:
        """The part at some keys, of a known type; None if it is missing or null."""
        part: Any = self._whole()
        for key in keys:
            part = None if part is None else part.get(key)
        return cast("T | None", part)

    def _texts(self, *keys: str) -> list[str]:
        """A list of texts; empty if it is missing."""
        return list(self._maybe(list, *keys) or [])

    def _whole(self) -> dict[str, Any]:
        if self._found is None:
            self._found = self.to_dict()
        return self._found

    def __getitem__(self, key: str, /) -> Any:
        return self._whole()[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self._whole())

    def __len__(self) -> int:
        return len(self._whole())

    def __str__(self) -> str:
        return self._text

    def __repr__(self) -> str:
        return f"<poecal.{type(self).__name__}: {self._answer}>"

    def _repr_html_(self) -> str:
        from ._poecal import _shown

        return _shown(self._text, self._warnings)

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._text, self._answer, self._json, self._warnings)
