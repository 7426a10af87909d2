"""Examples in Python run, and print what their twins in Rust print."""

import ast
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from program import ROOT, program

EXAMPLES = ROOT / "examples/python"
TWINS = sorted(path.stem for path in (ROOT / "crates/poecal/examples").glob("*.rs"))
NEEDS = {"with_pinocchio": "pinocchio", "with_mujoco": "mujoco", "with_moveit": "xacro", "with_yourdfpy": "yourdfpy", "with_rerun": "rerun"}


def run(script: Path, folder: Path) -> str:
    done = subprocess.run([sys.executable, script], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_every_example_has_its_twin():
    assert len(TWINS) >= 4
    assert sorted(path.stem for path in EXAMPLES.glob("*.py") if path.stem not in NEEDS) == TWINS


@pytest.mark.parametrize("name", TWINS)
def test_twins_print_the_same(name, tmp_path):
    # Built beside the program: scripts/rust_tests.py --build, or cargo build --release --examples.
    folder = Path(program()).parent / "examples"
    rust = subprocess.run([folder / name], capture_output=True, text=True)
    assert rust.returncode == 0, rust.stderr
    print(rust.stdout)
    assert run(EXAMPLES / f"{name}.py", tmp_path) == rust.stdout


@pytest.mark.parametrize("name", NEEDS)
def test_examples_with_other_packages_run(name, tmp_path):
    pytest.importorskip(NEEDS[name])
    printed = run(EXAMPLES / f"{name}.py", tmp_path)
    print(printed)
    for line in printed.splitlines():
        if line.startswith(("calibrated", "MuJoCo's tip")):
            # Rounding of a dozen products of poses of some metres.
            assert float(re.search(r"([0-9.e+-]+) mm", line)[1]) < 1e-9
        if line.startswith("planned by the calibrated"):
            # The effect of the session's noise of 0.05 mm and 0.01 deg.
            assert float(re.search(r"([0-9.e+-]+) mm", line)[1]) < 0.1


NOTEBOOKS = sorted((ROOT / "examples/notebook").glob("*.ipynb"))


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.name)
def test_notebooks_run_and_show_something(path, monkeypatch):
    """Each cell in order, its last expression shown as a notebook would show it."""
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.chdir(path.parent)
    cells = json.loads(path.read_text(encoding="utf-8"))["cells"]
    code = [cell for cell in cells if cell["cell_type"] == "code"]
    assert len(code) >= 5 and all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code), "it is stored without outputs"
    names, shown = {"__name__": "__main__"}, []
    for number, cell in enumerate(code):
        tree = ast.parse("".join(cell["source"]))
        last = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, f"{path.name}, cell {number}", "exec"), names)
        result = eval(compile(ast.Expression(last.value), f"{path.name}, cell {number}", "eval"), names) if last else None
        if result is not None:
            shown.append(getattr(result, "_repr_html_", lambda: None)() or repr(result))
    assert len(shown) >= 5 and all(shown)
    print(*shown, sep="\n")
