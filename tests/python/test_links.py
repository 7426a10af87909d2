"""Links in the repository's Markdown lead to files that git has and to headings that exist, by the rules of GitHub."""

import posixpath
import re
import subprocess
from urllib.parse import unquote

import pytest
from program import ROOT

FENCED = r"(?ms:^ *(?P<fence>`{3,}|~{3,})[^\n]*\n.*?^ *(?P=fence) *$)"
CODE = re.compile(rf"{FENCED}|(?s:<!--.*?-->)|(?P<ticks>`+)(?!`)[^\n]*?(?P=ticks)")
# [text](target "title") and ![text](target); [name]: target; <a href="target">, <img src="target">.
LINK = re.compile(
    r"\]\(\s*<?(?P<inline>[^)\s>]+)>?[^)\n]*\)"
    r"|^ {0,3}\[[^\]\n]+\]:\s*<?(?P<named>[^\s>]+)"
    r"|<(?:a|img)\s[^>]*?(?:href|src)=\"(?P<html>[^\"]+)\"",
    re.M,
)
HEADING = re.compile(rf"{FENCED}|^ {{0,3}}#{{1,6}}[ \t]+(?P<title>[^\n]+?)(?:[ \t]+#+)?[ \t]*$", re.M)
ANCHOR = re.compile(r"""<\w+\s[^>]*?(?:id|name)="([^"]+)\"""")


def slug(title):
    """A heading's anchor: its text in lower case, without punctuation, a hyphen for each blank."""
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", title)
    return re.sub(r"[^\w\- ]", "", text.strip().lower()).replace(" ", "-")


def anchors(text):
    """The anchors of a page; a repeated heading gets -1, -2, …"""
    found, seen = set(ANCHOR.findall(without_code(text))), {}
    for heading in HEADING.finditer(text):
        if heading["title"]:
            name = slug(heading["title"])
            seen[name] = seen.get(name, -1) + 1
            found.add(f"{name}-{seen[name]}" if seen[name] else name)
    return found


def without_code(text):
    """A page with blanks in place of code and comments."""
    return CODE.sub(lambda match: re.sub(r"[^\n]", " ", match[0]), text)


def links(text):
    """The targets of all links outside code and comments, each with its line."""
    text = without_code(text)
    for match in LINK.finditer(text):
        yield match["inline"] or match["named"] or match["html"], text.count("\n", 0, match.start()) + 1


def complaints(pages, there):
    """All dead links of pages (texts by path) in a repository with the files `there`, a line each; and the number of links checked."""
    folders = {posixpath.dirname(path) for path in there}
    folders |= {folder[:end] for folder in folders for end, letter in enumerate(folder) if letter == "/"} | {""}
    wrong, count = [], 0
    for page, text in pages.items():
        for target, line in links(text):
            if re.match(r"[a-z][a-z0-9+.-]*:|//", target, re.I):
                continue
            count += 1
            path, _, anchor = target.partition("#")
            place = posixpath.normpath(posixpath.join(posixpath.dirname(page), unquote(path))) if path else page
            place = "" if place == "." else place
            if place not in there and place not in folders:
                wrong.append(f"{page}:{line}: {target}: no such file in git")
            elif anchor and place in pages and unquote(anchor) not in anchors(pages[place]):
                wrong.append(f"{page}:{line}: {target}: no such heading")
    return wrong, count


@pytest.mark.skipif(not (ROOT / ".git").exists(), reason="not a clone: nobody knows which files git has")
def test_links_lead_somewhere(pytestconfig):
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    there = {path for path in listed.split("\0") if path and (ROOT / path).exists()}
    pages = {path: (ROOT / path).read_text(encoding="utf-8") for path in sorted(there) if path.endswith(".md")}
    wrong, count = complaints(pages, there)
    with pytestconfig.pluginmanager.getplugin("capturemanager").global_and_fixture_disabled():
        print(f"\nlinks: {count} of {len(pages)} Markdown files looked at, {len(wrong)} dead")
    assert not wrong, "\n".join(wrong)
    assert count > 100


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("[b](b.md)", "docs/a.md:1: b.md: no such file in git"),
        ("\n\n![picture](b.png 'title')", "docs/a.md:3: b.png: no such file in git"),
        ("[b]\n\n[b]: ../b.md", "docs/a.md:3: ../b.md: no such file in git"),
        ('<a href="b.html">', "docs/a.md:1: b.html: no such file in git"),
        ("[here](#there)", "docs/a.md:1: #there: no such heading"),
        ("[c](c.md#1-one)", "docs/a.md:1: c.md#1-one: no such heading"),
        ("[c](c.md#code)", "docs/a.md:1: c.md#code: no such heading"),
    ],
)
def test_dead_links_are_found(tmp_path, text, complaint):
    # Through a file, as a page is read.
    page = tmp_path / "a.md"
    page.write_text(text, encoding="utf-8")
    pages = {"docs/a.md": page.read_text(encoding="utf-8"), "docs/c.md": "# One\n```sh\n# code\n```\n"}
    assert complaints(pages, set(pages)) == ([complaint], 1)


def test_links_that_work_are_not_complained_of():
    pages = {
        "docs/a.md": "# A, *b* and `c_d`\n## Twice\n## Twice\n<!-- [x](x.md) -->\n`[x](x.md)`\n```text\n[x](x.md)\n```\n"
        "[1](#a-b-and-c_d) [2](#twice-1) [3](c.md#at) [4](https://x.example/y.md) [5](../web) [6](c.md) [7](.) "
        "[8](../web/src/x.js#L3)",
        "docs/c.md": '<a id="at"></a>',
    }
    assert complaints(pages, {*pages, "web/src/x.js"}) == ([], 7)


def test_pages_of_packages_link_to_where_they_are_not():
    """Registries and archives show these pages without the repository beside them."""
    pages = sorted(ROOT.glob("crates/*/README.md"))
    assert len(pages) >= 4
    for page in pages:
        targets = [target for target, _ in links(page.read_text(encoding="utf-8"))]
        assert targets and all(target.startswith("https://") for target in targets), page
        # The files that they name are there.
        named = [target.split("/blob/main/")[1] for target in targets if "/blob/main/" in target]
        assert all((ROOT / name).exists() for name in named), page
