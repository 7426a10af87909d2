"""The commands of the documentation are typed, and print the shown output."""

import subprocess
import sys

import pytest
from program import ROOT, program
from snippets import Counts, Page, blocks, matches, plain

PAGES = sorted(
    path
    for pattern in ["*.md", "docs/*.md", "docs/lou2009/*.md", "docs/howto/*.md", "crates/*/README.md", "examples/**/*.md", "validation/*.md", "benches/**/*.md"]
    for path in ROOT.glob(pattern)
)
COUNTS = Counts()


@pytest.fixture(scope="module", autouse=True)
def say_what_was_done(pytestconfig):
    """Reports after all pages the counts of their blocks; ./test shows it."""
    yield
    with pytestconfig.pluginmanager.getplugin("capturemanager").global_and_fixture_disabled():
        print(
            f"\ndocumentation: {COUNTS.run} blocks run, {COUNTS.compared} outputs compared, {COUNTS.written} files written, "
            f"{COUNTS.shown} shown only, {len(COUNTS.excused)} not run:"
        )
        for reason in COUNTS.excused:
            print(f"documentation: not run: {reason}")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_block_does_what_the_page_says(page, tmp_path):
    Page(page, tmp_path, COUNTS).run()


def test_the_readme_shows_the_real_robots_of_the_last_validation():
    sys.path.insert(0, str(ROOT / "scripts" / "docs"))
    from readme import real_robots, with_real_robots

    text = (ROOT / "README.md").read_text(encoding="utf-8")
    assert len(real_robots((ROOT / "validation" / "RESULTS.md").read_text(encoding="utf-8")).splitlines()) >= 7
    assert with_real_robots(text) == text, "`python scripts/docs/readme.py PROGRAM` writes the table"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_every_fence_begins_or_ends_a_block_that_is_found(page):
    fences = [line for line in page.read_text(encoding="utf-8").splitlines() if line.lstrip().startswith("```")]
    assert len(fences) == 2 * len(blocks(page))


def test_the_page_of_commands_is_what_the_program_says():
    script = ROOT / "scripts/docs/commands.py"
    page = subprocess.run([sys.executable, script, program()], capture_output=True, text=True, check=True).stdout
    shown = (ROOT / "docs/commands.md").read_text(encoding="utf-8")
    assert page == shown, f"make it anew: python {script.relative_to(ROOT)} {program()} > docs/commands.md"


def test_dots_stand_for_anything():
    assert matches("a … c\n…\nz", "a b c\n1\n2\nz") and matches("a\n…\nz", "a\nz")
    # Rounded figures to one in the last digit; counts, and figures that are not rounded, exactly.
    assert matches("held out 0.1577 mm", "held out 0.1576 mm") and matches("9.99 mm…", "10.00 mm (RMS)")
    assert not matches("0.1577 mm", "0.1575 mm") and not matches("180 rows", "181 rows") and not matches("1.5 mm", "1.6 mm")
    assert not matches("a … c", "a b d") and not matches("a", "a\nb")
    assert plain("within 2.1e-15 m  \n") == "within # m" and plain("4.9e3 1.2e-3") == "4.9e3 1.2e-3"
