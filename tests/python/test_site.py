"""The check of the documentation site finds what a page must not do."""

import sys

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
