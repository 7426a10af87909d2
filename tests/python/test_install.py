"""Each method of installing poecal, from an empty folder: the built files are installed without the clone beside them, and calibrate.

Builds are without optimisation, which makes them quick and changes nothing else, and the wheel is that of ./test. With POECAL_TRIALS=weekly the
static program is the distributed one, and its size is judged. The workflow that builds the distributed wheels calibrates with each of them.
"""

import hashlib
import json
import os
import shutil
import struct
import subprocess
import sys
import tarfile
import venv
import zipfile
from pathlib import Path

import pytest
from program import ROOT

try:
    import tomllib
except ModuleNotFoundError:
    import tomli as tomllib

TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve()
SETTINGS = {"OPT_LEVEL": "0", "LTO": "off", "CODEGEN_UNITS": "256", "DEBUG": "false"}
PROFILES = ["release", "dist"]
QUICK = {f"CARGO_PROFILE_{profile.upper()}_{name}": value for profile in PROFILES for name, value in SETTINGS.items()}
QUICK["CARGO_TARGET_DIR"] = str(TARGET / "install")
# In the order in which they are published.
CRATES = ["poecal-arm", "poecal-c", "poecal-detect", "poecal-numerics", "poecal-model", "poecal-programs", "poecal-fit", "poecal-calibrate",
          "poecal-plan", "poecal-storage", "poecal-formats", "poecal-import", "poecal-results", "poecal-compensate", "poecal-report", "poecal",
          "poecal-lou2009", "poecal-cli"]  # fmt: skip
LICENCES = ["LICENSE-APACHE", "LICENSE-MIT"]
LARGEST_PROGRAM = 20_000_000
AS_HANDED_OUT = os.environ.get("POECAL_TRIALS") in ("weekly", "full")
LINES = """
import poecal
robot = poecal.Robot.read("robot.urdf")
measured = poecal.Measurements.from_csv("points.csv", robot)
print(poecal.calibrate(robot, measured).verdict.level)
"""


def run(*command, cwd, **more) -> str:
    """Standard output of a command that must succeed, with an environment of its own if `env` states one."""
    done = subprocess.run([*map(str, command)], cwd=cwd, capture_output=True, text=True, **more)
    assert done.returncode == 0, f"{command}\n{done.stdout}{done.stderr}"
    return done.stdout


def installed(*command, cwd, **settings) -> str:
    """A run that builds: without optimisation, and with nothing of this test's own Python."""
    names = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "VIRTUAL_ENV"))}
    return run(*command, cwd=cwd, env=names | QUICK | settings)


def unoptimised(folder: Path) -> Path:
    """The folder, below which profiles optimise no single crate either; no variable decides that for these."""
    profiles = tomllib.loads((ROOT / "Cargo.toml").read_text())["profile"]
    names = sorted({name for profile in PROFILES for name in profiles[profile]["package"]})
    lines = [f"{profile}.package.{name}.opt-level = 0\n" for profile in PROFILES for name in names]
    (folder / ".cargo").mkdir(parents=True, exist_ok=True)
    (folder / ".cargo/config.toml").write_text("[profile]\n" + "".join(lines))
    return folder


@pytest.fixture
def empty(tmp_path) -> Path:
    """A folder with a robot and its measurements, and nothing else."""
    folder = tmp_path / "work"
    folder.mkdir()
    for name in ["robot.urdf", "points.csv"]:
        shutil.copy(ROOT / "examples/elbow" / name, folder)
    return folder


def calibrates(program: Path, folder: Path, *before) -> None:
    """The program, without any variable set, reproduces the results of the example."""
    printed = run(*before, program, "calibrate", "robot.urdf", "points.csv", cwd=folder, env={})
    assert printed.startswith("verdict       good")
    written = json.loads((folder / "poecal-out/calibration.json").read_text())
    # 0.0949 mm, up to rounding of a build without optimisation or for other processors.
    assert abs(written["accuracy"]["held_out"]["calibrated"]["position_mm"]["rms"] - 0.0949) < 1e-4


def environment(folder: Path) -> Path:
    """The programs of a new virtual environment."""
    venv.create(folder, with_pip=True)
    return folder / "bin"


def works_in_python(programs: Path, folder: Path) -> None:
    assert run(programs / "python", "-I", "-c", LINES, cwd=folder) == "good\n"
    calibrates(programs / "poecal", folder)


def test_pip_installs_the_wheel(empty, tmp_path):
    found = list((TARGET / "wheels").glob("poecal-*.whl"))
    if not found and os.environ.get("CI") != "true":
        pytest.skip(f"found no wheel in {TARGET / 'wheels'}, where ./test packages builds one")
    assert len(found) == 1, f"found {found}, expected the wheel that ./test packages builds into {TARGET / 'wheels'}"
    names = zipfile.ZipFile(found[0]).namelist()
    licences = sorted(name.split("/licenses/")[1] for name in names if "/licenses/" in name)
    assert licences == [*LICENCES, "THIRD-PARTY.txt"]
    metadata = zipfile.ZipFile(found[0]).read(next(name for name in names if name.endswith(".dist-info/METADATA"))).decode()
    assert "Calibrates robot arms" in metadata and "License-Expression: MIT OR Apache-2.0" in metadata
    assert "Project-URL: Repository, " in metadata and "abi3" in found[0].name
    programs = environment(tmp_path / "venv")
    run(programs / "pip", "install", "--quiet", found[0], cwd=empty)
    works_in_python(programs, empty)


def test_pip_installs_the_source_package(empty, tmp_path):
    maturin = [Path(sys.executable).parent / "maturin", "sdist", "--manifest-path", ROOT / "crates/poecal-py/Cargo.toml"]
    run(*maturin, "--out", tmp_path / "sdist", cwd=tmp_path)
    (source,) = (tmp_path / "sdist").iterdir()
    with tarfile.open(source) as archive:
        names = {name.split("/", 1)[1] for name in archive.getnames()}
    assert {"README.md", "PKG-INFO", "Cargo.lock"} <= names
    assert all(any(name.endswith(licence) for name in names) for licence in [*LICENCES, "THIRD-PARTY.txt"])
    programs = environment(tmp_path / "venv")
    # Sources of a package are as old as each other, so that the build of an earlier version would be taken for theirs.
    for built in (TARGET / "install/release/.fingerprint").glob("poecal*"):
        shutil.rmtree(built)
    # The folder into which pip unpacks it.
    installed(programs / "pip", "install", "--quiet", source, cwd=empty, TMPDIR=str(unoptimised(tmp_path / "unpacked")))
    works_in_python(programs, empty)


def test_cargo_installs_from_the_packaged_crates(empty, tmp_path):
    said = subprocess.run(
        ["cargo", "publish", "--dry-run", "--workspace", "--no-verify", "--locked", "--allow-dirty", "--target-dir", tmp_path / "dry"],
        cwd=ROOT,
        capture_output=True,
        text=True,
    )
    assert said.returncode == 0, said.stderr
    warnings = [line for line in said.stderr.splitlines() if line.startswith("warning") and "already exists on" not in line]
    assert warnings == ["warning: aborting upload due to dry run"] * len(CRATES)
    names = [word for crate in CRATES for word in ("--package", crate)]
    run("cargo", "package", *names, "--no-verify", "--locked", "--allow-dirty", "--target-dir", tmp_path / "made", cwd=ROOT)
    patches = []
    for crate in CRATES:
        (packed,) = (tmp_path / "made/package").glob(f"{crate}-[0-9]*.crate")
        with tarfile.open(packed) as archive:
            archive.extractall(tmp_path / "crates", filter="data")
        folder = tmp_path / "crates" / packed.stem
        assert {"README.md", *LICENCES} <= {path.name for path in folder.iterdir()}, crate
        # Replacement of crates.io, for dependencies that are not yet there.
        patches += ["--config", f'patch.crates-io.{crate}.path="{folder}"'] if crate != "poecal-cli" else []
    # The versions of others that the clone names, as `cargo install --locked` has them from crates.io.
    shutil.copy(ROOT / "Cargo.lock", folder)
    installed("cargo", "metadata", "--offline", "--format-version", "1", "--manifest-path", folder / "Cargo.toml", *patches, cwd=tmp_path)
    installed("cargo", "install", "--locked", "--offline", "--path", folder, "--root", tmp_path / "root", *patches, cwd=tmp_path)
    calibrates(tmp_path / "root/bin/poecal", empty)


def steps(text: str):
    """The steps of a Dockerfile: words of each, with continued lines joined."""
    lines = text.replace("\\\n", " ").splitlines()
    return [line.split(None, 1) for line in lines if line.strip() and not line.startswith("#")]


def tracked() -> list[str]:
    """Contents of a clone: files under version control, in their present state."""
    return run("git", "ls-files", cwd=ROOT).splitlines()


@pytest.fixture(scope="module")
def image() -> tuple[Path, list[str]]:
    """The steps of Dockerfile, done in folders that represent the images: the root of the last one, and its program.

    Among the base images, `scratch` is empty, and of Rust's only Rust is needed, which is here too.
    """
    parent = TARGET / "image"
    if AS_HANDED_OUT:
        shutil.rmtree(parent / ".cargo", ignore_errors=True)
    else:
        unoptimised(parent)
    roots, root, where, entry = {}, None, None, []
    for word, rest in steps((ROOT / "Dockerfile").read_text()):
        if word == "FROM":
            base, *named = rest.split(" AS ")
            assert base == "scratch" or base.startswith("rust:"), f"the image {base} is unknown here"
            root = parent / (named[0] if named else "last")
            roots[named[0] if named else "last"] = root
            # The compiled files of an earlier run are kept; cargo finds the changes.
            if not named:
                shutil.rmtree(root, ignore_errors=True)
            root.mkdir(parents=True, exist_ok=True)
        elif word == "WORKDIR":
            where = root / rest.lstrip("/")
            where.mkdir(parents=True, exist_ok=True)
        elif word == "COPY" and rest == ". .":
            ignored = (ROOT / ".dockerignore").read_text().split()
            for name in tracked():
                if not any(Path(name).is_relative_to(path) for path in ignored):
                    (where / name).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copy2(ROOT / name, where / name, follow_symlinks=True)
        elif word == "COPY":
            words = rest.split()
            source = roots[words.pop(0).removeprefix("--from=")] if words[0].startswith("--from=") else ROOT
            for name in words[:-1]:
                shutil.copy2(source / name.lstrip("/"), root / words[-1].lstrip("/"))
        elif word == "RUN":
            quick = {} if AS_HANDED_OUT else {name: value for name, value in QUICK.items() if name != "CARGO_TARGET_DIR"}
            names = {name: value for name, value in os.environ.items() if name != "CARGO_TARGET_DIR"} | quick
            run("bash", "-euo", "pipefail", "-c", rest, cwd=where, env=names)
        else:
            assert word == "ENTRYPOINT", f"the step {word} is unknown here"
            entry = json.loads(rest)
    return root, entry


def test_the_image_holds_the_program_and_its_licences(image, empty):
    root, entry = image
    assert sorted(path.name for path in root.iterdir()) == ["LICENSE-APACHE", "LICENSE-MIT", "THIRD-PARTY.txt", "data", "poecal"]
    assert entry == ["/poecal"]
    if os.geteuid() == 0:
        # As in a container: nothing of this machine is there.
        for name in ["robot.urdf", "points.csv"]:
            shutil.copy(empty / name, root / "data")
        inside = "import os, sys; os.chroot(sys.argv[1]); os.chdir('/data'); os.execv(sys.argv[2], sys.argv[2:])"
        printed = run(sys.executable, "-c", inside, root, entry[0], "calibrate", "robot.urdf", "points.csv", cwd="/", env={})
        assert printed.startswith("verdict       good") and (root / "data/poecal-out/report.html").exists()
    else:
        calibrates(root / entry[0].lstrip("/"), empty)


def needs_an_interpreter(program: Path) -> bool:
    """True if an ELF program requires a loader of shared libraries (a segment of type PT_INTERP)."""
    data = program.read_bytes()
    (offset,), (size, count) = struct.unpack_from("<Q", data, 0x20), struct.unpack_from("<HH", data, 0x36)
    return any(struct.unpack_from("<I", data, offset + k * size)[0] == 3 for k in range(count))


@pytest.mark.skipif(sys.platform != "linux", reason="programs elsewhere need the system's library")
def test_the_archive_of_the_static_program(image, empty, tmp_path):
    program = image[0] / "poecal"
    size = program.stat().st_size
    print(f"static program: {size / 1e6:.2f} MB{'' if AS_HANDED_OUT else ', without optimisation'}")
    assert (size <= LARGEST_PROGRAM or not AS_HANDED_OUT) and not needs_an_interpreter(program)
    archive = Path(run(sys.executable, ROOT / "scripts/package.py", program, "x86_64-unknown-linux-gnu", tmp_path / "out", cwd=ROOT).strip())
    digest, name = Path(f"{archive}.sha256").read_text().split()
    assert (digest, name) == (hashlib.sha256(archive.read_bytes()).hexdigest(), archive.name)
    with tarfile.open(archive) as packed:
        packed.extractall(tmp_path / "unpacked", filter="data")
    (folder,) = (tmp_path / "unpacked").iterdir()
    assert {"poecal", "README.md", "completions", "man", "THIRD-PARTY.txt", *LICENCES} <= {path.name for path in folder.iterdir()}
    assert len(list((folder / "completions").iterdir())) == 5 and (folder / "man/poecal-calibrate.1").exists()
    calibrates(folder / "poecal", empty)
