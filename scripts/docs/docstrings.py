"""Docstrings as the page of the Python package shows them.

Signatures and types come from the package's stubs. What is compiled has its docstrings in the installed package only, so they are
taken from there. Examples (`>>>`) are shown as code, wherever they stand.
"""

import importlib
import inspect
import re

import griffe

EXAMPLE = re.compile(r"^(?P<indent> *)>>> .*(?:\n(?P=indent)\S.*)*", re.M)


class Docstrings(griffe.Extension):
    """Completes docstrings before they are taken apart."""

    def on_package(self, *, pkg, loader, **kwargs):
        complete(pkg)


def complete(thing):
    if not thing.docstring and (text := installed_docstring(thing)):
        thing.docstring = griffe.Docstring(text, parent=thing, parser="numpy")
    if thing.docstring:
        thing.docstring.value = EXAMPLE.sub(fenced, thing.docstring.value)
    for member in thing.members.values():
        if not member.is_alias:
            complete(member)


def installed_docstring(thing):
    """The docstring of a compiled class, function, method or property; None for everything else."""
    if thing.is_module or thing.name.startswith("__"):
        return None
    found = importlib.import_module(thing.module.path)
    for name in thing.path.removeprefix(f"{thing.module.path}.").split("."):
        found = getattr(found, name, None)
    documented = inspect.isclass(found) or inspect.isroutine(found) or inspect.isdatadescriptor(found)
    return inspect.getdoc(found) if documented else None


def fenced(match):
    indent = match["indent"]
    return f"{indent}```pycon\n{match[0]}\n{indent}```"
