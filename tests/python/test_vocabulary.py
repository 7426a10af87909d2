"""The pages for users keep to docs/vocabulary.md as far as that can be checked by whole phrases."""

import json
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


# Names, comments and messages of the sources, by the rules of docs/style.md. Tests are read for their names and comments too.
SOURCES = sorted(path for path in ROOT.glob("crates/*/**/*.rs") if "target" not in path.relative_to(ROOT).parts)
COUNTS = ROOT / "tests/vocabulary.json"
COMMENT = re.compile(r"^\s*//[/!]? (.*)")
REPORTING = re.compile(r"\b(tells?|told|says?|said|gives?|given)\b", re.IGNORECASE)
TEXT = re.compile(r'"((?:[^"\\]|\\.)*)"')
# Types of tests may share names, and those of the Python package mirror the library's.
TYPE = re.compile(r"^(?:pub(?:\([^)]*\))? )?(?:struct|enum|trait|union) (\w+)", re.MULTILINE)
SHARED_NAMES = {"Error", "Options"}
BARE = re.compile(r"\bfn (moved|told|said|seen|kept|given|left|taken|judged|found|stated|beside|within|around|along|known|held|shown|named|of)\(")


def without_tests(text):
    return text.split("#[cfg(test)]\nmod ")[0]


def counted():
    """How often each rule of the style is broken."""
    texts = {path: path.read_text(encoding="utf-8") for path in SOURCES}
    comments = [found[1] for text in texts.values() for line in text.splitlines() if (found := COMMENT.match(line))]
    sources = {path: without_tests(text) for path, text in texts.items() if "src" in path.relative_to(ROOT).parts and path.name != "tests.rs"}
    library = {path: text for path, text in sources.items() if path.relative_to(ROOT).parts[1] != "poecal-py"}
    code = [line for text in sources.values() for line in text.splitlines() if not COMMENT.match(line)]
    types = [name for text in library.values() for name in TYPE.findall(text)]
    return {
        "functions_called_of": sum(len(re.findall(r"\bfn of\b", text)) for text in texts.values()),
        "functions_that_are_participles": sum(len(BARE.findall(text)) for text in sources.values()),
        "comments_that_begin_with_what": sum(bool(re.match(r"(What|Where|How|Of|Whether)\b", comment)) for comment in comments),
        "comments_that_tell": sum(bool(REPORTING.search(comment)) for comment in comments),
        "messages_that_tell": sum(bool(REPORTING.search(text)) for line in code for text in TEXT.findall(line)),
        "types_of_one_name": sum(types.count(name) > 1 for name in set(types) - SHARED_NAMES),
    }


def test_exceptions_from_the_style_only_become_fewer():
    limits = json.loads(COUNTS.read_text())
    found = counted()
    print(found)
    assert found == limits, "above: keep to docs/style.md; below: lower the number in tests/vocabulary.json"


CODE_PAGES = [ROOT / "ARCHITECTURE.md", ROOT / "CONTRIBUTING.md"]
DEFINED = re.compile(r"\b(?:struct|enum|trait|type|union|fn|mod|const|static)\s+([A-Za-z_]\w*)")
# Names of Rust and of its tools in these pages.
FOREIGN = {"None", "Some", "Ok", "Err", "Option", "Result", "Vec", "String", "Cargo", "Python"}


def test_pages_and_comments_name_files_that_exist():
    crates = {}
    for path in SOURCES:
        crates.setdefault(path.relative_to(ROOT).parts[1], set()).add(path.name)
    everywhere = set().union(*crates.values())
    missing = []
    for path in [*CODE_PAGES, *SOURCES]:
        lines = path.read_text(encoding="utf-8").splitlines()
        own = everywhere if path in CODE_PAGES else crates[path.relative_to(ROOT).parts[1]] | {"build.rs"}
        for number, line in enumerate(lines, 1):
            if path in CODE_PAGES or COMMENT.match(line):
                of_crate = re.match(r"\*\*`(poecal[a-z0-9-]*)`\*\*", line)
                files = crates[of_crate[1]] if of_crate else everywhere if "`poecal-" in line else own
                missing += [f"{path.relative_to(ROOT)}:{number}: {name}" for name in re.findall(r"`([a-z0-9_]+\.rs)`", line) if name not in files]
    assert missing == []


def test_the_architecture_names_code_that_exists():
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    defined = {name for path in SOURCES for name in DEFINED.findall(path.read_text(encoding="utf-8"))}
    named = {part for found in re.findall(r"\b[A-Za-z_]\w*(?:::\w+)+", text) for part in found.split("::")} - FOREIGN
    crates = {path.name.replace("-", "_") for path in (ROOT / "crates").iterdir()}
    assert named - defined - crates - {"commands", "row"} == set()
