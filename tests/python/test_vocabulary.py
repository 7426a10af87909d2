"""The pages for users keep to docs/vocabulary.md as far as that can be checked by whole phrases."""

import re

import pytest
from program import ROOT
from test_links import without_code

VOCABULARY = "docs/vocabulary.md"
PATTERNS = ["*.md", "docs/**/*.md", "examples/**/*.md", "validation/*.md", "crates/*/README.md", "crates/*/src/**/*.md"]
PAGES = sorted({path for pattern in PATTERNS for path in ROOT.glob(pattern)} - {ROOT / VOCABULARY})
# Words of the last column that are wrong anywhere. Others have a right use too ("zero", "open", "near"), and are left to readers.
NEVER = [
    "as drawn",
    "drawing's worth",
    "what a value is more than its reading",
    "posture",
    "what the fit leaves",
    "kept back",
    "rows left out in turn",
    "what is to be expected",
    "kept promise",
    "grossly off",
    "hardly told",
    "beside the optimum",
    "unknowns told",
]


def found(text):
    """The words of NEVER in a text, with any line ends and capitals; code does not count."""
    plain = " ".join(without_code(text).lower().replace("’", "'").split())
    return [words for words in NEVER if re.search(rf"\b{re.escape(words)}s?\b", plain)]


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_page_has_no_words_that_the_vocabulary_excludes(page):
    assert found(page.read_text(encoding="utf-8")) == []


def test_excluded_words_are_those_of_the_vocabulary():
    rows = [line.strip("| ").split("|") for line in (ROOT / VOCABULARY).read_text(encoding="utf-8").splitlines() if line.startswith("|")]
    excluded = {words.strip() for row in rows if len(row) == 3 for words in row[2].split(",")}
    assert set(NEVER) <= excluded


def test_excluded_words_are_found_across_line_ends_and_not_in_code():
    assert found("The axes stand As\ndrawn, and it\nkept promises.") == ["as drawn", "kept promise"]
    assert found("`as drawn`, drawn as a line\n```text\nkept promise\n```\n") == []
