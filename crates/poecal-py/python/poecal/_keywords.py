"""Keywords that a function does not have are answered with the nearest one that it has."""

from __future__ import annotations

import functools
import re
from collections.abc import Callable
from types import BuiltinFunctionType, MethodDescriptorType, ModuleType
from typing import Any

from ._errors import KeywordError

REFUSED = re.compile(r"got an unexpected keyword argument '(\w+)'|takes no keyword arguments")
# Units at the end of a keyword.
UNIT = re.compile(r"_(nm|um|mm|cm|m|in|urad|mrad|rad|deg|arcmin|arcsec)$")


def unknown(function: Callable[..., Any], keyword: str) -> KeywordError:
    """The error for a keyword that a function does not have."""
    import inspect

    from ._poecal import _nearest, _renamed

    kinds = (inspect.Parameter.POSITIONAL_OR_KEYWORD, inspect.Parameter.KEYWORD_ONLY)
    known = [it.name for it in inspect.signature(function).parameters.values() if it.kind in kinds and it.name != "self"]
    without = UNIT.sub("", keyword)
    bare = {UNIT.sub("", it): it for it in known}
    new = _renamed(without, list(bare))
    if new is not None:
        return KeywordError(f"{function.__name__}: found the keyword `{keyword}`, which is now `{bare[new]}`")
    same = [it for it in known if UNIT.search(it) and UNIT.sub("", it) == without]
    near = same[0] if same else _nearest(keyword, known)
    if near is None:
        expected = f"expected one of {', '.join(known)}" if known else "expected none"
        return KeywordError(f"{function.__name__}: found the keyword `{keyword}`, {expected}")
    units = f" Its numbers are in {near.rsplit('_', 1)[1]}; a text has its own unit, as {near}=\"0.05 m\"." if same else ""
    return KeywordError(f"{function.__name__}: found the keyword `{keyword}`, did you mean `{near}`?{units}")


def answering(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function, with an answer to keywords that it does not have."""

    @functools.wraps(function)
    def call(*arguments: Any, **keywords: Any) -> Any:
        try:
            return function(*arguments, **keywords)
        except TypeError as error:
            refused = REFUSED.search(str(error))
            keyword = refused and (refused[1] or next(iter(keywords), None))
            # Not a keyword that a function of the user does not have.
            if keyword not in keywords:
                raise
            wrong = unknown(function, keyword)
        raise wrong

    return call


def answer(module: ModuleType) -> None:
    """Makes all public functions and methods of a compiled module answer."""
    for name, thing in list(vars(module).items()):
        if name.startswith("_"):
            continue
        if isinstance(thing, type):
            answer_methods(thing)
        elif isinstance(thing, BuiltinFunctionType):
            setattr(module, name, answering(thing))


def answer_methods(owner: type) -> None:
    """Makes all methods of a class answer; its constructor answers by itself."""
    for name, thing in list(vars(owner).items()):
        if name.startswith("_"):
            continue
        if isinstance(thing, staticmethod):
            setattr(owner, name, staticmethod(answering(thing.__func__)))
        elif isinstance(thing, MethodDescriptorType):
            setattr(owner, name, answering(thing))
