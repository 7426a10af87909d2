"""The kinematics for C: the example is compiled and run, with and without Rust's standard library, and beside the program."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from program import ELBOW, ROOT, poecal

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve()
SOURCES = ROOT / "crates/poecal-c"
# The profile of controllers, or the one that compiles sooner.
PROFILE = os.environ.get("POECAL_CONTROLLER", "tested-controller")
MEANT = ["0.1", "-0.2", "0.3", "0.4", "-0.5", "0.6"]


@pytest.fixture(scope="module")
def arms(tmp_path_factory) -> Path:
    """A folder with a calibration and its arms."""
    folder = tmp_path_factory.mktemp("arms")
    poecal("calibrate", ELBOW, ROOT / "examples/elbow/points.csv", "--out", folder / "results")
    poecal("export", folder / "results/calibration.json", "--format", "c", "--model", "corrected", "--out", folder / "arms.h")
    return folder


@pytest.fixture(scope="module")
def expected(arms) -> np.ndarray:
    """Commands of the program."""
    names = [f"joint{k}" for k in range(1, 7)]
    (arms / "program.csv").write_text(",".join(names) + "\n" + ",".join(MEANT) + "\n")
    written = poecal("compensate", arms / "results/calibration.json", arms / "program.csv").splitlines()
    return np.array(written[1].split(","), float)


def build(*options: str) -> None:
    subprocess.run(["cargo", "build", "--locked", "-q", "-p", "poecal-c", *options], cwd=ROOT, check=True, env=os.environ | {"CARGO_TARGET_DIR": str(TARGET)})


def check(command: list, expected: np.ndarray) -> None:
    done = subprocess.run([*map(str, command), *MEANT], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    apart = np.abs(np.array(done.stdout.split(), float) - expected).max()
    print(f"{apart:.1e} rad from the program; {done.stderr.strip()}")
    # Rounding of the iteration, and 15 digits.
    assert apart < 1e-12


# The second library has no standard library of Rust: it would not link with one, since it has a panic handler and an allocator of its own.
@pytest.mark.parametrize("options", [[], ["--no-default-features"]])
def test_the_example_of_c_commands_what_the_program_does(arms, expected, tmp_path, options):
    compiler = os.environ.get("CC") or shutil.which("cc")
    build("--profile", PROFILE, *options)
    flags = ["-O2", "-Wall", "-Wextra", "-Werror", f"-I{arms}", f"-I{SOURCES / 'include'}"]
    sources = [SOURCES / "examples/compensate.c", TARGET / PROFILE / "libpoecal_c.a"]
    libraries = ["-lm"] if "--no-default-features" in options else ["-lm", "-lpthread", "-ldl"]
    subprocess.run([compiler, *flags, *map(str, sources), *libraries, "-o", tmp_path / "compensate"], check=True)
    check([tmp_path / "compensate"], expected)
    # Only numbers are an arm; too few readings are reported.
    done = subprocess.run([tmp_path / "compensate", "1"], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (2, "expected 6 joint readings\n")


@pytest.mark.skipif(sys.platform != "linux", reason="the library has another name")
def test_ctypes_commands_what_the_program_does(arms, expected):
    build("--profile", PROFILE)
    library = TARGET / PROFILE / "libpoecal_c.so"
    check([sys.executable, SOURCES / "examples/compensate.py", library, arms / "arms.h"], expected)
