"""Writes the docstrings of the compiled module into its stubs, which editors and the documentation site read.

    python scripts/docs/stubs.py            # with the package installed

Docstrings are written once, above the functions in crates/poecal-py/src; tests/python/test_types.py reports if the stubs have others.
"""

import ast
import inspect
from pathlib import Path

STUBS = Path(__file__).resolve().parents[2] / "crates/poecal-py/python/poecal/_poecal.pyi"


def with_docstrings(text, module):
    """The stubs' text with the module's docstrings in place of its own."""
    lines = text.splitlines()
    for node, docstring in reversed(list(documented(ast.parse(text), module))):
        indent = " " * (node.col_offset + 4)
        assert '"""' not in docstring and "\\" not in docstring, node.name
        body = [f"{indent}{line}".rstrip() for line in f'"""{docstring}'.splitlines()]
        body = [f'{body[0]}"""'] if len(body) == 1 else [*body, f'{indent}"""']
        first = node.body[0]
        if ast.get_docstring(node) is not None:
            lines[first.lineno - 1 : first.end_lineno] = body
        elif isinstance(node, ast.ClassDef):
            lines[node.lineno : node.lineno] = body
        else:
            lines[first.lineno - 1 : first.lineno] = [lines[first.lineno - 1].removesuffix(" ..."), *body]
    return "\n".join(lines) + "\n"


def documented(parent, owner):
    """Public definitions and their docstrings, in order; of overloads, the first."""
    seen = set()
    for node in parent.body:
        if not isinstance(node, ast.ClassDef | ast.FunctionDef) or node.name.startswith("_") or node.name in seen:
            continue
        seen.add(node.name)
        thing = getattr(owner, node.name)
        yield node, inspect.getdoc(thing)
        if isinstance(node, ast.ClassDef):
            yield from documented(node, thing)


if __name__ == "__main__":
    from poecal import _poecal

    STUBS.write_text(with_docstrings(STUBS.read_text(encoding="utf-8"), _poecal), encoding="utf-8")
