"""The checks of the project's dependencies detect faults."""

import importlib.util
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


def script(name):
    spec = importlib.util.spec_from_file_location(name, ROOT / "scripts" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


dependencies = script("check_dependencies")
python_lock = script("check_python_lock")

RULES = {
    "licenses": {"allow": ["MIT", "Apache-2.0", "Apache-2.0 WITH LLVM-exception"]},
    "bans": {"multiple-versions": "deny", "wildcards": "deny", "allow-wildcard-paths": True, "deny": [{"name": "bad", "reason": "why"}]},
    "sources": {"unknown-registry": "deny", "unknown-git": "deny", "allow-registry": ["https://github.com/rust-lang/crates.io-index"]},
}


def crate(name="good", version="1.0.0", **others):
    registry = "registry+https://github.com/rust-lang/crates.io-index"
    return {"name": name, "version": version, "license": "MIT", "source": registry, "dependencies": [], **others}


@pytest.mark.parametrize(
    ("expression", "allowed"),
    [
        ("MIT", True),
        ("GPL-3.0", False),
        ("GPL-3.0 OR MIT", True),
        ("MIT AND NCSA", False),
        ("(MIT OR GPL-3.0) AND Apache-2.0", True),
        ("MIT OR Apache-2.0 AND NCSA", True),
        ("NCSA AND MIT OR GPL-3.0", False),
        ("Apache-2.0 WITH LLVM-exception", True),
        ("MIT WITH LLVM-exception", False),
        ("NCSA/MIT", True),
    ],
)
def test_licences_are_read_as_expressions(expression, allowed):
    assert dependencies.is_allowed(expression, set(RULES["licenses"]["allow"])) is allowed


@pytest.mark.parametrize("expression", ["", "MIT OR", "(MIT", "MIT Apache-2.0", "AND MIT"])
def test_broken_licences_are_refused(expression):
    with pytest.raises(ValueError):
        dependencies.is_allowed(expression, {"MIT"})


@pytest.mark.parametrize(
    ("package", "complaint"),
    [
        (crate(license="NCSA"), "good 1.0.0: found the licence `NCSA`"),
        (crate(license=None), "good 1.0.0: found no licence expression"),
        (crate(name="bad"), "bad 1.0.0: is refused: why"),
        (crate(source="git+https://example.org/x"), "good 1.0.0: comes from git+https://example.org/x"),
        (crate(source="registry+https://example.org"), "good 1.0.0: comes from registry+https://example.org"),
        (crate(dependencies=[{"name": "x", "req": "*"}]), "good 1.0.0: takes any version of x"),
    ],
)
def test_a_crate_that_breaks_a_rule_is_named(package, complaint):
    (found,) = dependencies.complaints(RULES, [package], [package])
    assert found.startswith(complaint)


def test_two_versions_are_refused_where_not_only_tests_need_them():
    packages = [crate(), crate(version="2.0.0")]
    assert not list(dependencies.complaints(RULES, packages, packages[:1]))
    (found,) = dependencies.complaints(RULES, packages, packages)
    assert found.startswith("good: found the versions 1.0.0, 2.0.0")
    rules = {**RULES, "bans": {**RULES["bans"], "skip": [{"crate": "good@2", "reason": "why"}]}}
    assert not list(dependencies.complaints(rules, packages, packages))
    by_path = crate(source=None, dependencies=[{"name": "x", "req": "*", "path": "/x"}])
    assert not list(dependencies.complaints(RULES, [by_path], [by_path]))


def test_a_rule_that_is_not_applied_is_a_complaint():
    rules = {**RULES, "bans": {**RULES["bans"], "skip-tree": []}}
    (found,) = dependencies.complaints(rules, [], [])
    assert found.startswith("deny.toml: found [bans] skip-tree")


LOCK = """# Not to be edited.
numpy==2.2.6 ; python_full_version < '3.11' \\
    --hash=sha256:00
    # via
    #   -r requirements-test.txt
    #   pin
six==1.17.0 \\
    --hash=sha256:00
    # via pin
"""


def test_the_lock_is_compared_with_the_list():
    def found(listed, locked=LOCK):
        return list(python_lock.complaints(listed, locked))

    assert found("# words\nnumpy>=2,<3\n") == []
    assert found("numpy>=2,<3\npin>=3\n") == ["pin: is listed and not locked"]
    assert found("numpy[data]>=2,<3\n") == []
    assert found("numpy>=2.3,<3\n") == ["numpy 2.2.6: is locked, but >=2.3 is listed"]
    assert found("numpy>=1,<2.2.6\n") == ["numpy 2.2.6: is locked, but <2.2.6 is listed"]
    assert found("") == ["numpy 2.2.6: is locked as listed, but is not listed"]
    assert found("numpy>=2,<3\n", LOCK.replace("    --hash=sha256:00\n", "", 1)) == ["numpy 2.2.6: is locked without checksums"]


def test_every_build_is_of_the_locked_crates():
    """A build that may write Cargo.lock anew is not the one that was checked."""
    files = [*(ROOT / "scripts").glob("*"), *(ROOT / ".github/workflows").glob("*.yml"), ROOT / "test", ROOT / "validation/weekly"]
    asked = 0
    for path in filter(Path.is_file, files):
        for line in path.read_text(encoding="utf-8").splitlines():
            # A command of a shell, or its words in a list of Python's.
            plain = " " + re.sub('[",]', "", line).replace("[", " ") + " "
            if line.lstrip().startswith("#") or "--version >" in line or "cargo clippy --version" in plain:
                continue
            words = [f" cargo {word} " for word in ("test", "build", "clippy", "doc", "check", "install")] + ["maturin build "]
            if any(word in plain for word in words):
                asked += 1
                assert "--locked" in line, f"{path.name}: {line}"
    assert asked > 12


