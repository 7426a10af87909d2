"""Examples in Python run, and print what their twins in Rust print."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from program import ROOT

EXAMPLES = ROOT / "examples/python"
TWINS = sorted(path.stem for path in (ROOT / "crates/poecal/examples").glob("*.rs"))
NEEDS = {"with_pinocchio": "pinocchio", "with_yourdfpy": "yourdfpy", "with_rerun": "rerun"}


def run(script: Path, folder: Path) -> str:
    done = subprocess.run([sys.executable, script], cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def test_every_example_has_its_twin():
    assert len(TWINS) >= 4
    assert sorted(path.stem for path in EXAMPLES.glob("*.py") if path.stem not in NEEDS) == TWINS


@pytest.mark.parametrize("name", TWINS)
def test_twins_print_the_same(name, tmp_path):
    # `cargo test` builds the examples.
    folder = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "debug/examples"
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
        if line.startswith("calibrated"):
            # Rounding of a dozen products of poses of some metres.
            assert float(re.search(r"([0-9.e+-]+) mm", line)[1]) < 1e-9
