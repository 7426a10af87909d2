"""The runner of the steps of ./test: prerequisites, failures, and its output."""

import sys

import pytest
from program import ROOT

sys.path.insert(0, str(ROOT / "scripts"))
import steps  # noqa: E402
from steps import Run, Step  # noqa: E402

SAYS = [sys.executable, "-c", "print('twelve of them')"]
FAILS = [sys.executable, "-c", "print('the reason'); raise SystemExit(3)"]


def whole(capsys, *steps):
    """Exit code and lines of a run."""
    code = Run(list(steps)).whole()
    return code, capsys.readouterr().out


def test_a_step_that_fails_is_named_first_with_what_it_printed(capsys):
    code, said = whole(capsys, Step("reader", [FAILS]), Step("writer", [SAYS], after=["reader"]), Step("page", [SAYS], shows="^twelve"))
    assert code == 1
    end = said[said.index("=== FAILED: reader") :]
    assert "the reason" in end.splitlines()[2]
    summary = end[end.index("=== summary") :]
    assert "reader: FAILED (exit code 3)" in summary and "writer: skipped, it needs `reader`" in summary
    assert "page: ok" in summary and "    twelve of them" in summary
    assert "slowest steps" in summary and "FAILED: reader (0." in summary.splitlines()[-1]


def test_what_passes_says_so(capsys):
    code, said = whole(capsys, Step("reader", [SAYS, SAYS]), Step("writer", [SAYS], after=["reader"]))
    assert code == 0 and said.splitlines().count("twelve of them") == 3 and "all passed (0." in said.splitlines()[-1]


@pytest.mark.parametrize(("ci", "code", "word"), [("true", 1, "FAILED"), ("", 0, "skipped")])
def test_a_tool_that_is_missing_is_a_failure_only_where_all_has_to_be_there(capsys, monkeypatch, ci, code, word):
    monkeypatch.setenv("CI", ci)
    lacking = Step("page", [SAYS], lacks="browser")
    found, said = whole(capsys, lacking, Step("after it", [SAYS], after=["page"]), Step("old", [SAYS], lacks="old Rust", may_lack=True))
    assert found == code and f"page: {word}, found no browser" in said and "old: skipped, found no old Rust" in said
    assert "after it: skipped, it needs `page`" in said and "twelve" not in said


# Writes one file, and ends when the other is there.
MEETS = """
import os, pathlib, time
pathlib.Path(os.environ["OWN"]).touch()
for _ in range(600):
    if pathlib.Path(os.environ["OTHER"]).exists():
        raise SystemExit(0)
    time.sleep(0.1)
raise SystemExit("the other step has not begun in a minute")
"""


def test_steps_run_side_by_side_with_variables_of_their_own(capsys, tmp_path):
    one, other = str(tmp_path / "one"), str(tmp_path / "other")
    command = [sys.executable, "-c", MEETS]
    code, _ = whole(capsys, Step("one", [command], env={"OWN": one, "OTHER": other}), Step("other", [command], env={"OWN": other, "OTHER": one}))
    assert code == 0


# Prints its times.
TIMED = [sys.executable, "-c", "import time; begin = time.time(); time.sleep(0.5); print('ran', begin, time.time())"]


@pytest.mark.parametrize("waits", [False, True])
def test_a_step_that_waits_takes_no_processor_and_runs_alone_of_its_kind(capsys, monkeypatch, waits):
    monkeypatch.setattr(steps, "PROCESSORS", 2)
    many = [Step(f"step {k}", [TIMED], waits=waits) for k in range(4)]
    code, said = whole(capsys, *many, Step("other", [TIMED], waits=not waits))
    spans = sorted(tuple(map(float, line.split()[1:])) for line in said.splitlines() if line.startswith("ran "))
    at_once = max(sum(begin <= at < end for begin, end in spans) for at, _ in spans)
    assert code == 0 and len(spans) == 5 and at_once == (2 if waits else 3)


def test_a_step_is_listed_behind_those_that_it_needs():
    with pytest.raises(AssertionError, match="writer is listed before"):
        Run([Step("writer", [SAYS], after=["reader"]), Step("reader", [SAYS])])
