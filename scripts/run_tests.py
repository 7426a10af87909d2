#!/usr/bin/env python3
"""The steps of `./test`, of `./test packages` and of validation/weekly; scripts/steps.py runs them. `./test quick` is scripts/quick.

    scripts/run_tests.py change|packages|weekly [STEP…]    all steps, or those of these names with what they need
"""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

from rust_tests import ROOT, target
from steps import Run, Step

PYTHON = ".venv/bin/python"
PYTEST = [PYTHON, "-m", "pytest", "-rs", "--rootdir", ".", "-p", "no:cacheprovider", "--durations=5"]
# Lines of pytest, and of Node's test runner, that report the tests done.
PYTEST_SHOWS = r"^=+ .* in [0-9.]+s|^documentation: \d|^SKIPPED |^(FAILED|ERROR) "
NODE_SHOWS = r"^# (tests|pass|fail|skipped) |^# .*(bytes|differs? by|processor time|MB)|^# real robots|^# .* s after the drop|^[^ ].*# SKIP|^ *not ok"
CARGO_SHOWS = r"^ *Finished|^(error|warning):"
# Documentation of the crates that have users, which scripts/build-docs puts beside the site, and of the parts of the library.
DOCUMENTED = ["poecal", "poecal-arm", "poecal-detect", "poecal-lou2009", "poecal-numerics", "poecal-model", "poecal-programs", "poecal-fit",
              "poecal-calibrate", "poecal-plan", "poecal-storage", "poecal-formats", "poecal-import", "poecal-results", "poecal-compensate",
              "poecal-report"]  # fmt: skip
DOCUMENTATION = ["cargo", "doc", "--locked", "--quiet", "--no-deps", *(word for crate in DOCUMENTED for word in ("-p", crate))]
# Tests that only ./test packages needs.
INSTALL = "tests/python/test_install.py"
SITE = "tests/python/test_site.py"
WASM = "wasm32-unknown-unknown"
# Levels of vector instructions, the best first (crates/poecal-numerics/src/kernels/simd.rs), and the tests that compare digits: programs of Rust
# tests, Python files, and the part of web/ that compares with the program. Every change is tried by a few of them at each level, and by all at the
# best.
LEVELS = ["avx512", "avx2", "neon", "plain"]
DIGITS_OF_RUST = ["poecal-cli it ", "poecal-lou2009 it ", "it determinism", "-simulated_disk", "-hostile",
                  "-detect::", "-photographs::"]  # pictures: no vector instructions but those of the calibration
DIGITS_OF_PYTHON = ["tests/python/test_package_and_program.py", "tests/python/test_docs.py", "tests/python/test_examples.py"]
SOME_OF_RUST = ["poecal-lou2009 it ", "it determinism", "poecal-cli it example", "poecal-cli it readme"]
SOME_OF_PYTHON = ["tests/python/test_package_and_program.py", "tests/python/test_docs.py::test_every_block_does_what_the_page_says[README.md]"]


def has(*command: str) -> bool:
    """True if a command exists and succeeds."""
    return shutil.which(command[0]) is not None and subprocess.run(command, cwd=ROOT, capture_output=True, check=False).returncode == 0


def lack(tool: str, is_there: bool) -> str | None:
    return None if is_there else tool


def has_chromium() -> bool:
    """True if there is a browser, where web/test/browser.mjs searches for it."""
    names = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome", "/usr/bin/google-chrome-stable"]
    given = os.environ.get("CHROMIUM")
    return any(os.access(name, os.X_OK) for name in ([given] if given else names))


def has_node() -> bool:
    return shutil.which("npm") is not None and has("node", "-e", "process.exit(process.versions.node.split('.')[0] < 20 ? 1 : 0)")


def has_standard_library(name: str) -> bool:
    sysroot = subprocess.run(["rustc", "--print", "sysroot"], cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
    return (Path(sysroot) / "lib/rustlib" / name / "lib").is_dir()


def tools() -> list[Step]:
    """Tools of the tests: Python packages and, if Node.js is available, npm packages."""
    installed = ROOT / "web/node_modules/package-lock.json"
    is_current = installed.is_file() and installed.read_bytes() == (ROOT / "web/package-lock.json").read_bytes()
    install = [["npm", "ci", "--prefix", "web", "--ignore-scripts", "--no-audit", "--no-fund"], ["cp", "web/package-lock.json", "web/node_modules/"]]
    return [
        Step("Python tools", [["scripts/python-env"]]),
        Step("web tools", [] if is_current else install, shows=r"^npm (error|ERR)", lacks=lack("Node.js 20 or newer with npm", has_node())),
    ]


def rust_build() -> Step:
    """The one build of Rust tests, program and examples."""
    return Step("Rust build", [[sys.executable, "scripts/rust_tests.py", "--build"]], shows=CARGO_SHOWS)


def package_build() -> Step:
    """The wheel, of the same build, and the package in the environment of the tests."""
    wheels = target() / "wheels"
    return Step(
        "package build",
        [
            ["rm", "-rf", str(wheels)],
            [".venv/bin/maturin", "build", "--locked", "--profile", "tested", "--compatibility", "linux", "--interpreter", PYTHON,
             "--manifest-path", "crates/poecal-py/Cargo.toml", "--out", str(wheels)],
            [PYTHON, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--force-reinstall", "--no-deps", "--no-index",
             "--find-links", str(wheels), "poecal"],
        ],
        after=["Rust build", "Python tools"], shows="rror:",
    )  # fmt: skip


def levels() -> list[str]:
    """The levels of this machine, by the program, which refuses others."""
    program = os.environ["POECAL_PROGRAM"]
    found = []
    for level in LEVELS:
        done = subprocess.run([program, "schema"], env={**os.environ, "POECAL_SIMD": level}, capture_output=True, text=True, check=False)
        if done.returncode == 0:
            found.append(level)
        elif done.returncode != 2 or "expected one of the levels of this machine" not in done.stderr:
            sys.exit(f"{program} schema at the level {level}: exit code {done.returncode}\n{done.stderr}")
    return found


def in_browser(files: Iterable[str]) -> list[str]:
    """The command of some files of web/test."""
    return ["sh", "-c", "cd web && exec node --test --test-concurrency=1 --test-reporter tap " + " ".join(f"test/{name}" for name in files)]


def change() -> list[Step]:
    """All that a change of the product can break."""
    clippy = has("cargo", "clippy", "--version")
    node, browser = has_node(), lack("Chromium", has_chromium())
    alone = ["app.parts.test.mjs", "workflows.test.mjs"]
    pages = sorted(path.name for path in (ROOT / "web/test").glob("*.test.mjs") if path.name not in ("npm.test.mjs", "site.test.mjs", *alone))
    return [
        Step("format", [["cargo", "fmt", "--all", "--check"]], shows="^Diff in", lacks=lack("rustfmt", has("cargo", "fmt", "--version"))),
        Step("imports", [[sys.executable, "scripts/check-imports"]], shows="^imports go| may depend only |^only |import each other"),
        Step("recipes apply", [[sys.executable, "scripts/recipes", "--apply"]], shows=r"\.patch: "),
        rust_build(),
        Step("sizes", [[sys.executable, "scripts/sizes"], [sys.executable, "scripts/sizes", "--program", os.environ["POECAL_PROGRAM"]]], after=["Rust build"],
             shows=r": found \d|^\d+ commands| in \d+ files"),
        *tools(),
        # Beside the long compilation of the library, in a folder of its own: it would wait there, and a processor with it.
        Step("lints", [["cargo", "clippy", "--locked", "--workspace", "--all-targets", "--", "-D", "warnings"]], shows=CARGO_SHOWS, lacks=lack("clippy", clippy)),
        package_build(),
        Step("licences of others", [[PYTHON, "scripts/third_party.py", "--check"]], after=["Python tools"], shows="^THIRD-PARTY"),
        Step("dependencies", [[PYTHON, "scripts/check_dependencies.py"]], after=["Python tools"], shows="^dependencies: |: (found|is|comes|takes) "),
        Step("Python packages", [[PYTHON, "scripts/check_python_lock.py"]], after=["Python tools"], shows="^requirements|: is "),
        Step("Python tests", [[*PYTEST, "--ignore", INSTALL, "--ignore", SITE, "tests/python", "crates/poecal-py/tests"]],
             after=["package build", "web tools"] if node else ["package build"], shows=PYTEST_SHOWS),
        Step("Rust tests", [[sys.executable, "scripts/rust_tests.py"]], after=["Rust build"], shows=r"^FAILED |^\d+ passed, |^fuzz "),
        Step("doc examples", [["cargo", "test", "--locked", "--profile", "tested", "--workspace", "--doc"]], after=["package build"], shows="^test result: .* [1-9][0-9]* passed"),
        Step("scripts and types", [["node", "web/build.mjs", "--check"], ["node", "web/npm/types.mjs", "--check"]], after=["web tools"], shows="^report.(js|css): |^types"),
        Step("web without a browser", [in_browser(alone)], after=["Rust build", "web tools"], shows=NODE_SHOWS, waits=True),
        Step("report in a browser", [in_browser(name for name in pages if not name.startswith("app."))], after=["Rust build", "scripts and types"], shows=NODE_SHOWS, lacks=browser, waits=True),
        digits("some digits at every level", "some-levels"),
    ]  # fmt: skip


def digits(name: str, kind: str) -> Step:
    """Tests that compare digits, at every level of vector instructions."""
    return Step(name, [[sys.executable, "scripts/run_tests.py", kind]], after=["package build"], shows=r"^level |" + PYTEST_SHOWS + r"|^FAILED |^\d+ passed, ")


def weekly() -> list[Step]:
    """The part of validation/weekly that is built as every change is."""
    return [*tools(), rust_build(), package_build(), digits("digits at every level", "levels")]


def packages() -> list[Step]:
    """Everything that only a release can break: other machines, the oldest Rust, every installation method, npm and the whole site."""
    oldest = next(line.split('"')[1] for line in (ROOT / "Cargo.toml").read_text().splitlines() if line.startswith("rust-version"))
    clippy = has("cargo", "clippy", "--version")
    node, browser = has_node(), lack("Chromium", has_chromium())
    pages = sorted(path.name for path in (ROOT / "web/test").glob("app.*test.mjs") if path.name != "app.parts.test.mjs")
    wasm = lack(f"standard library of {WASM} (rustup target add {WASM})", has_standard_library(WASM))
    return [
        # The build of ./test, or an equal one.
        rust_build(),
        *tools(),
        Step("npm build", [["node", "web/app/build.mjs"]], after=["web tools"], shows="^poecal.html: |^web/npm", lacks=wasm),
        package_build(),
        Step("installation", [[*PYTEST, INSTALL]], after=["package build"], shows=PYTEST_SHOWS + "|^static program"),
        Step("C on a controller", [[*PYTEST, "tests/python/test_c.py"]], after=["package build"], shows=PYTEST_SHOWS, env={"POECAL_CONTROLLER": "controller"}),
        Step("npm package", [in_browser(["npm.test.mjs"])], after=["npm build", "Rust build"], shows=NODE_SHOWS),
        Step("report of every real robot", [in_browser(["report.test.mjs"])], after=["Rust build", "web tools"], shows=NODE_SHOWS, lacks=browser, waits=True, env={"POECAL_REPORTS": "all"}),
        Step("page in a browser", [in_browser(pages)], after=["npm build", "Rust build"], shows=NODE_SHOWS, lacks=browser, waits=True),
        *(Step(f"lints of {name}", [["cargo", "clippy", "--locked", "--profile", "tested", "-p", "poecal", "-p", "poecal-wasm", "--target", name, "--", "-D", "warnings"]], shows=CARGO_SHOWS,
               lacks=lack("clippy", clippy) or lack(f"standard library of {name} (rustup target add {name})", has_standard_library(name)))
          for name in ("aarch64-unknown-linux-gnu", WASM)),
        Step(f"oldest Rust ({oldest})", [["cargo", f"+{oldest}", "check", "--locked", "--workspace"]], shows=CARGO_SHOWS, may_lack=True,
             lacks=lack(f"Rust {oldest} (rustup toolchain install {oldest} --profile minimal)", has("cargo", f"+{oldest}", "--version"))),
        Step("documentation of the crates", [DOCUMENTATION], shows=CARGO_SHOWS, env={"RUSTDOCFLAGS": "-D warnings"}),
        Step("documentation site", [["scripts/build-docs"], [*PYTEST, SITE]], after=["Python tools", "npm build"] if node and not wasm else ["Python tools", "web tools"] if node else ["Python tools"],
             shows="^site: |^(WARNING|ERROR) |" + PYTEST_SHOWS, env={"POECAL_PAGE": "web/app/dist/poecal.html"} if node and not wasm else {}),
        Step("site in a browser", [in_browser(["site.test.mjs"])], after=["documentation site", "web tools", "Rust build"], shows=NODE_SHOWS, lacks=browser, waits=True),
    ]  # fmt: skip


def at_every_level(rust: list[str], python: list[str]) -> int:
    """These tests, which compare digits, at each level but the best, at which everything else runs."""
    here = levels()
    usual = os.environ.get("POECAL_SIMD", here[0])
    print(f"level {usual}: all tests run at it", flush=True)
    codes = []
    for level in here:
        if level == usual:
            continue
        print(f"level {level}", flush=True)
        for command in [[sys.executable, "scripts/rust_tests.py", *rust], [*PYTEST, *python]]:
            codes.append(subprocess.run(command, cwd=ROOT, env={**os.environ, "POECAL_SIMD": level}, check=False).returncode)
            sys.stdout.flush()
    return int(any(codes))


def main() -> int:
    # One profile and one folder for Rust tests, program and package.
    os.environ["POECAL_PROFILE"] = "tested"
    os.environ["CARGO_TARGET_DIR"] = str(target().absolute())
    os.environ.setdefault("CARGO_TERM_COLOR", "never")
    os.environ["POECAL_PROGRAM"] = str(target() / "tested/poecal")
    datasets = ROOT.parent / "shared/datasets"
    if "POECAL_DATASETS" not in os.environ and datasets.is_dir():
        os.environ["POECAL_DATASETS"] = str(datasets.resolve())
    kind = sys.argv[1] if len(sys.argv) > 1 else "change"
    if kind == "levels":
        return at_every_level(DIGITS_OF_RUST, DIGITS_OF_PYTHON)
    if kind == "some-levels":
        return at_every_level(SOME_OF_RUST, SOME_OF_PYTHON)
    kinds = {"change": change, "packages": packages, "weekly": weekly}
    if kind not in kinds:
        sys.exit(f"found `{kind}`, expected one of {', '.join(kinds)}")
    steps, names = kinds[kind](), sys.argv[2:]
    unknown = set(names) - {step.name for step in steps}
    if unknown:
        sys.exit(f"found no step {', '.join(sorted(unknown))}, expected one of {', '.join(step.name for step in steps)}")
    wanted = set(names or [step.name for step in steps])
    # With their prerequisites, which are quick if nothing has changed.
    for step in reversed(steps):
        wanted |= set(step.after) if step.name in wanted else set()
    return Run([step for step in steps if step.name in wanted]).whole()


sys.exit(main())
