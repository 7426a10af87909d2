"""The documentation site: its check finds forbidden contents of a page, and it does not depend on one builder."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from program import ROOT

sys.path.insert(0, str(ROOT / "scripts/docs"))
from check_site import complaints  # noqa: E402


@pytest.mark.parametrize(
    ("content", "complaint"),
    [
        ('<script src="https://cdn.example/x.js"></script>', "page.html loads https://cdn.example/x.js, from elsewhere"),
        ('<link rel="stylesheet" href="//cdn.example/x.css">', "page.html loads //cdn.example/x.css, from elsewhere"),
        ('<link rel="preconnect" href="https://fonts.example">', "page.html loads https://fonts.example, from elsewhere"),
        ("<style>@import 'https://x.example/x.css';</style>", "page.html loads https://x.example/x.css, from elsewhere"),
        ('<p style="background: url(http://x.example/x.png)">', "page.html loads http://x.example/x.png, from elsewhere"),
        ('<img srcset="a.png 1x, https://x.example/b.png 2x">', "page.html loads https://x.example/b.png, from elsewhere"),
        ('<img src="b.png">', "page.html loads b.png, which is not there"),
        ('<a href="other.html">', "page.html leads to other.html, which is not there"),
        ('<a href="page.html#there">', "page.html leads to page.html#there, a place that is not there"),
    ],
)
def test_what_a_page_must_not_do_is_found(tmp_path, content, complaint):
    (tmp_path / "a.png").touch()
    (tmp_path / "page.html").write_text(content)
    found, _ = complaints(tmp_path)
    assert found == [complaint]


def test_fonts_in_a_style_sheet_are_looked_at(tmp_path):
    (tmp_path / "site.css").write_text('@font-face { src: url("https://fonts.example/x.woff2") }')
    assert complaints(tmp_path)[0] == ["site.css loads https://fonts.example/x.woff2, from elsewhere"]


def test_links_that_a_reader_may_follow_are_allowed(tmp_path):
    (tmp_path / "a.png").touch()
    (tmp_path / "page.html").write_text('<h1 id="here"><a href="https://x.example"><a href="#here"><img src="a.png">')
    assert complaints(tmp_path) == ([], "1 pages, 1 things loaded and 2 links looked at")


def test_another_builder_makes_the_same_pages(tmp_path):
    """MkDocs Material is kept until May 2027; Zensical, its successor, reads the same pages and settings, but no variables in them."""
    settings = (ROOT / "mkdocs.yml").read_text()
    for variable, folder in [("DOCS_PAGES, target/docs-pages", "pages"), ("DOCS_PACKAGE, crates/poecal-py/python", "package")]:
        assert f"!ENV [{variable}]" in settings
        settings = settings.replace(f"!ENV [{variable}]", folder)
    (tmp_path / "mkdocs.yml").write_text(settings)
    subprocess.run([sys.executable, ROOT / "scripts/docs/stage.py", tmp_path / "pages"], check=True)
    # The page that calibrates, which scripts/build-docs builds or replaces.
    (tmp_path / "pages/app").mkdir()
    (tmp_path / "pages/app/index.html").write_text("<!DOCTYPE html>")
    # The package's texts alone, as scripts/build-docs takes them.
    (tmp_path / "package/poecal").mkdir(parents=True)
    for path in (ROOT / "crates/poecal-py/python/poecal").glob("*.py*"):
        shutil.copy(path, tmp_path / "package/poecal")
    shutil.copytree(ROOT / "scripts/docs", tmp_path / "scripts/docs")
    run = subprocess.run([Path(sys.executable).parent / "zensical", "build", "--strict"], cwd=tmp_path, capture_output=True, text=True)
    assert run.returncode == 0 and "No issues found" in run.stdout + run.stderr, run.stdout + run.stderr
    site = tmp_path / "target/site"
    named = set(re.findall(r": ([\w/-]+)\.md$", settings, re.M))
    assert len(named) > 25 and named <= {path.relative_to(site).with_suffix("").as_posix() for path in site.rglob("*.html")}
    # Pages of errors have links of their own, and the documentation of the crate comes later.
    wrong = [line for line in complaints(site)[0] if not line.startswith("404.html") and "rust/poecal" not in line]
    assert wrong == []
