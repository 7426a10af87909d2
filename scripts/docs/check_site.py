"""Checks a built site: every page and picture that a page names exists, and no page loads anything from elsewhere.

    python scripts/docs/check_site.py target/site
"""

import re
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

# Elements that a browser loads by itself. Links that a reader may follow are not among them.
LOADED = {("script", "src"), ("img", "src"), ("iframe", "src"), ("source", "src"), ("video", "src"), ("audio", "src"), ("object", "data"), ("embed", "src")}
# Kinds of <link> that are loaded, or prepare that; others (canonical, next, prev) describe the page.
LOADING_LINKS = {"stylesheet", "icon", "preload", "modulepreload", "preconnect", "dns-prefetch", "prefetch", "manifest", "shortcut"}
IN_STYLE = re.compile(r"""url\(\s*['"]?([^'")]+)|@import\s+['"]([^'"]+)""")


class Page(HTMLParser):
    """Loads and links of a page."""

    def __init__(self):
        super().__init__()
        self.loaded, self.links, self.ids, self.in_style = [], [], set(), False

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.in_style = tag == "style"
        self.ids.update(value for name, value in attributes.items() if name in ("id", "name") and value)
        self.loaded += [value for name, value in attributes.items() if (tag, name) in LOADED and value]
        self.loaded += [part.split()[0] for part in (attributes.get("srcset") or "").split(",") if part.strip()]
        self.loaded += in_style(attributes.get("style") or "")
        if tag == "link" and LOADING_LINKS & set((attributes.get("rel") or "").split()):
            self.loaded.append(attributes.get("href") or "")
        if tag == "a" and attributes.get("href"):
            self.links.append(attributes["href"])

    def handle_data(self, data):
        if self.in_style:
            self.loaded += in_style(data)

    def handle_endtag(self, tag):
        self.in_style = False


def in_style(text):
    return [first or second for first, second in IN_STYLE.findall(text)]


def complaints(site):
    """Everything that is wrong, a line each, and the number of items checked."""
    pages = {}
    for path in sorted(site.rglob("*.html")):
        pages[path] = page = Page()
        page.feed(path.read_text(encoding="utf-8"))
    loaded = [(path, url) for path, page in pages.items() for url in page.loaded]
    loaded += [(path, url) for path in sorted(site.rglob("*.css")) for url in in_style(path.read_text(encoding="utf-8"))]
    # rustdoc checks its own links.
    links = [(path, url) for path, page in pages.items() if not path.is_relative_to(site / "rust") for url in page.links]
    wrong = [f"{path.relative_to(site)} loads {url}{why}" for path, url in loaded if (why := against_loading(path, url))]
    wrong += [f"{path.relative_to(site)} leads to {url}{why}" for path, url in links if (why := against_link(path, url, pages))]
    return wrong, f"{len(pages)} pages, {len(loaded)} things loaded and {len(links)} links looked at"


def against_loading(path, url):
    parts = urlsplit(url)
    if parts.netloc or parts.scheme not in ("", "data"):
        return ", from elsewhere"
    # rustdoc loads a list of the types that implement a trait even if there are none.
    if not parts.scheme and "trait.impl" not in parts.path and not (path.parent / unquote(parts.path)).exists():
        return ", which is not there"
    return None


def against_link(path, url, pages):
    parts = urlsplit(url)
    if parts.scheme or parts.netloc:
        return None
    place = (path.parent / unquote(parts.path)).resolve() if parts.path else path
    if not place.exists():
        return ", which is not there"
    if parts.fragment and place in pages and unquote(parts.fragment) not in pages[place].ids:
        return ", a place that is not there"
    return None


if __name__ == "__main__":
    found, counts = complaints(Path(sys.argv[1]).resolve())
    for line in found:
        print(f"site: {line}")
    print(f"site: {counts}; {len(found)} wrong")
    sys.exit(1 if found else 0)
