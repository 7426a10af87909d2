"""Sentences that deny something of poecal are true: each has the test that shows it, or is shown here.

SHOWN lists every such sentence of the documentation by a part of it. One that is missing there fails, and so does an entry that no page has.
"""

import re
import subprocess

import pytest
from program import ROOT, poecal, program

PAGES = [ROOT / name for name in ["README.md", "COMPARE.md", "ARCHITECTURE.md", "CITATION.cff"]] + sorted([*(ROOT / "docs").glob("*.md"), *(ROOT / "docs/howto").glob("*.md")])
# Made by a script, or reasons for decisions.
NOT = {"commands.md", "decisions.md", "api-rust.md"}
DENIES = re.compile(r"\b(does not|do not|cannot|has no|have no|not yet|is not read|are not read|not supported)\b|\bonly\b")
OF_POECAL = re.compile(r"\b(poecal|program|package|page|report|library)\b|^(It|They)\b", re.IGNORECASE)

HERE = "tests/python/test_denials.py::"
PLACES = "crates/poecal-cli/tests/it/places.rs::"
# Denials about mathematics, about another program, or about the reader's own work.
ELSEWHERE = "it is of something else"
SHOWN = {
    "It does not read URDF or CSV": ELSEWHERE,
    "Program and package import it, the library does not": "scripts/check-imports",
    "It also checks that `parameters` and `measurement`": "scripts/check-imports",
    "it is the only crate of the library that opens files": "scripts/check-imports",
    "The library reads and writes files only through the trait `Disk`": "scripts/check-imports",
    "results are written, but the verdict is *do not use*": "crates/poecal-cli/tests/it/exit_codes.rs::a_calibration_that_should_not_be_used_is_written_and_ends_with_1",
    "They do not determine the orientation of the tool": "tests/python/test_docs.py::test_every_block_does_what_the_page_says",
    "in terms that do not depend on this choice": "tests/python/test_compare.py",
    "they cannot be calibrated, but an arm beside them can": "crates/poecal-results/tests/it/model_errors.rs",
    "poecal has no such singularity": "crates/poecal-calibrate/tests/it/noise_free.rs",
    "read tables with joint columns only": HERE + "test_tables_of_joints_are_read_for_their_joints",
    "`force` replaces only results that poecal wrote": PLACES + "settings_lead_nowhere_else_and_let_only_results_go",
    "An existing file is replaced only with `--force`": PLACES + "a_file_that_exists_is_replaced_only_with_force",
    "`force = true` replaces only results of poecal": PLACES + "settings_lead_nowhere_else_and_let_only_results_go",
    "the report is put in place just before the results": "crates/poecal-cli/tests/it/simulated_disk/mod.rs::whatever_fails_a_place_is_old_or_new_or_completed_by_the_next_run",
    "the page has no address to send anything to": "web/test/app.test.mjs",
    "What has no control in the page": "web/test/app.test.mjs",
    "It passes only if the rows show that": "crates/poecal-cli/tests/it/acceptance.rs::limits_are_kept_exceeded_or_neither",
    "It does not measure": ELSEWHERE,
    "only the results folder is written to": "tests/python/test_install.py",
    "it does not know where your nest will be": HERE + "test_a_list_is_judged_by_the_tip_of_the_model",
    "It does not talk to the tracker or drive the robot": HERE + "test_nothing_can_talk_to_a_network",
    "it does not read the tracker's own project files": HERE + "test_no_pictures_are_read",
    "only their order can be mistaken": "crates/poecal-calibrate/tests/it/forensics.rs",
    "poecal does not write `<calibration rising": HERE + "test_a_urdf_keeps_the_drivers_calibration_as_it_is",
    "prints what your rows determine, and names what they do not": "tests/python/test_docs.py::test_every_block_does_what_the_page_says",
    "It is the only length here": ELSEWHERE,
    "The NEON code has been run under emulation only": ELSEWHERE,
    "It returns a figure of matplotlib and does not show it": "crates/poecal-py/tests/test_residuals.py::test_a_picture_is_drawn_and_not_shown",
    "The page adds only sums over the rows": "web/test/report.test.mjs",
    "So poecal has no offsets among its unknowns": "crates/poecal-lou2009/tests/it/formulations.rs",
    "they do not change during the fit": ELSEWHERE,
    "They matter only in fits without a prior": ELSEWHERE,
    "they are not observable, and do not matter": ELSEWHERE,
    "is your URDF with only the corrected numbers replaced": "crates/poecal-formats/tests/it/urdf_patch.rs::only_changed_values_are_replaced_and_missing_ones_inserted",
}


def denials() -> list[str]:
    found = []
    for page in PAGES:
        if page.name in NOT:
            continue
        text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
        sentences = re.split(r"(?<=[.!?:;])\s+|\n|\|", text)
        found += [f"{page.relative_to(ROOT)}: {it.strip()}" for it in sentences if DENIES.search(it) and OF_POECAL.search(it.strip())]
    return found


def test_every_sentence_that_denies_something_of_poecal_is_shown_to_be_true():
    found = denials()
    missing = [it for it in found if not any(part in it for part in SHOWN)]
    assert not missing, "\n".join(missing)
    whole = "\n".join(found)
    assert not [part for part in SHOWN if part not in whole]
    for shown in SHOWN.values():
        place, _, name = shown.partition("::")
        if shown != ELSEWHERE:
            text = (ROOT / place).read_text(encoding="utf-8")
            assert not name or re.search(rf"\b{name}\(", text), shown
    print(f"{len(found)} sentences, {sum(it == ELSEWHERE for it in SHOWN.values())} of something else")


def test_a_list_is_judged_by_the_tip_of_the_model():
    # The option by which `plan` knows the position of a nest.
    model = ROOT / "examples/elbow/robot.urdf"
    words = [program(), "plan", model, "--rows", model.with_name("points.csv"), "--target-offset", "60,0,30mm"]
    run = subprocess.run(words, capture_output=True, text=True)
    assert run.returncode == 2 and "cannot be used with" in run.stderr, run.stderr


def test_tables_of_joints_are_read_for_their_joints(tmp_path):
    rows = (ROOT / "examples/elbow/points.csv").read_text().splitlines()
    table = "\n".join(row for row in rows if not row.startswith("#"))
    (tmp_path / "all.csv").write_text(table + "\n")
    (tmp_path / "joints.csv").write_text("\n".join(",".join(row.split(",")[:6]) for row in table.splitlines()) + "\n")
    model = ROOT / "examples/elbow/robot.urdf"
    assert poecal("predict", model, tmp_path / "all.csv") == poecal("predict", model, tmp_path / "joints.csv")


@pytest.mark.parametrize("content", [b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR", b"\xff\xd8\xff\xe0\x00\x10JFIF\x00", b"SQLite format 3\x00"])
def test_no_pictures_are_read(tmp_path, content):
    (tmp_path / "taken.bin").write_bytes(content * 20)
    done = subprocess.run([program(), "calibrate", ROOT / "examples/elbow/robot.urdf", tmp_path / "taken.bin"], cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 2 and done.stderr.count("\n") == 1 and not (tmp_path / "poecal-out").exists()


def test_nothing_can_talk_to_a_network():
    crates = re.findall(r'^name = "(.*)"$', (ROOT / "Cargo.lock").read_text(), flags=re.MULTILINE)
    assert not {"reqwest", "hyper", "ureq", "tokio", "mio", "socket2", "curl", "native-tls", "rustls"} & set(crates)


def test_a_urdf_keeps_the_drivers_calibration_as_it_is(tmp_path):
    text = (ROOT / "examples/elbow/robot.urdf").read_text().replace("<axis", '<calibration rising="0.1"/><axis', 1)
    (tmp_path / "robot.urdf").write_text(text)
    poecal("calibrate", tmp_path / "robot.urdf", ROOT / "examples/elbow/points.csv", "--out", tmp_path / "out")
    assert re.findall("<calibration .*?/>", (tmp_path / "out/calibrated.urdf").read_text()) == ['<calibration rising="0.1"/>']
