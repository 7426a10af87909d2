"""Stages the pages of the documentation site: texts from elsewhere in the repository, their links, and formulas as pictures.

    python scripts/docs/stage.py FOLDER

The contents of FOLDER afterwards are plain Markdown and HTML, which any program can build that reads mkdocs.yml.
"""

import posixpath
import re
import shutil
import sys
from pathlib import Path
from xml.etree import ElementTree

import ziamath

ROOT = Path(__file__).resolve().parents[2]

# Texts outside docs/ that are pages of the site: the file in the repository, and the page.
PAGES = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "ARCHITECTURE.md": "architecture.md",
    "COMPARE.md": "compare.md",
    "CONTRIBUTING.md": "contributing.md",
    "validation/RESULTS.md": "validation.md",
}

# Weight of a page in the search: a page that answers a question in people's words precedes one that has some of the words.
BOOST = {"faq.md": 4, "architecture.md": 0.5, "contributing.md": 0.5, "changelog.md": 0.5}

# Code, which the patterns below leave alone.
CODE = r"(?ms:^(?P<fence> *`{3,}).*?^(?P=fence)`* *$)|`[^`\n]+`"
LINK = re.compile(rf"{CODE}|(?P<text>\[[^\]\n]*\])\((?P<target>[^)\s]+)\)")
FORMULA = re.compile(rf"(?ms:^(?P<indent> *)```math\n(?P<block>.*?)^ *```$)|{CODE}|(?<![\\$])\$(?P<inline>[^$\n]+)\$")
# Comments are left out; the text of one that begins with `site:` is on the site alone.
COMMENT = re.compile(rf"{CODE}|(?P<comment><!--(?P<site> site: )?(?P<text>(?s:.*?)) *-->\n?)")

# Placeholder of a formula's TeX until that can no longer be taken for something else.
PLACEHOLDER = "formula"

# Size of the text's letters in the pictures' own units.
EM = 20


def stage(folder):
    """Writes all pages, and copies all else of docs/ except results that are only linked from elsewhere."""
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(ROOT / "docs", folder, ignore=shutil.ignore_patterns("*.md", "results.json"))
    sources = {path.relative_to(ROOT).as_posix(): path.relative_to(ROOT / "docs").as_posix() for path in (ROOT / "docs").rglob("*.md")} | PAGES
    there = set(sources.values()) | {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    for source, page in sources.items():
        target = folder / page
        target.parent.mkdir(parents=True, exist_ok=True)
        boost = f"---\nsearch:\n  boost: {BOOST[page]}\n---\n\n" if page in BOOST else ""
        target.write_text(boost + staged((ROOT / source).read_text(encoding="utf-8"), source, page, there), encoding="utf-8")


def staged(markdown, source, page, there):
    """A page's Markdown as the site has it."""
    # Words after a language are for other readers, as in rust,no_run.
    markdown = re.sub(r"^( *```\w+),\S*$", r"\1", markdown, flags=re.M)
    # Checklists, which need no extension in this form.
    markdown = re.sub(r"^( *)- \[ \] ", r"\1- ☐ ", markdown, flags=re.M)
    markdown = COMMENT.sub(lambda match: (match["text"] if match["site"] else "") if match["comment"] else match[0], markdown)
    markdown = LINK.sub(lambda match: link(match, source, page, there), markdown)
    glyphs = {}
    markdown = FORMULA.sub(lambda match: formula(match, glyphs), markdown)
    return f'{markdown}\n\n<svg class="glyphs" aria-hidden="true">{"".join(glyphs.values())}</svg>\n' if glyphs else markdown


def link(match, source, page, there):
    """A link as the site has it: to a page, or plain text if its target is not on the site."""
    target = match["target"]
    if target is None or re.match(r"[a-z]+:|#", target):
        return match[0]
    path, _, anchor = target.partition("#")
    place = posixpath.normpath(posixpath.join(posixpath.dirname(source), path))
    if not (ROOT / place).exists():
        # Left for the site's builder to complain about.
        return match[0]
    uri = PAGES.get(place, place.removeprefix("docs/"))
    if uri not in there:
        return match["text"][1:-1]
    relative = posixpath.relpath(uri, posixpath.dirname(page) or ".")
    return f"{match['text']}({relative}{'#' + anchor if anchor else ''})"


def formula(match, glyphs):
    """A formula as HTML in one line, which Markdown passes on."""
    if match["block"] is not None:
        tex = match["block"].strip()
        number = re.search(r"\\tag\{([^}]*)\}", tex)
        tex = re.sub(r"\s*\\tag\{[^}]*\}", "", tex)
        pictures = "".join(f"<span>{picture(part, glyphs, inline=False)}</span>" for part in parts(tex))
        shown = f'<span class="number">({number[1]})</span>' if number else ""
        # Within an item of a list a formula belongs to the item's text.
        tag = "span" if match["indent"] else "div"
        return f'{match["indent"]}<{tag} class="formula"><span class="parts">{pictures}</span>{shown}</{tag}>\n'
    return picture(match["inline"], glyphs, inline=True) if match["inline"] is not None else match[0]


def parts(tex):
    """Adjacent parts of a formula with wide spaces between them, which may be stacked on a narrow page."""
    found, start = [], 0
    for space in re.finditer(r"\\q?quad\b", tex):
        before = tex[: space.start()]
        if depth(before) == 0 and before.rstrip().endswith((",", ";")):
            found.append(tex[start : space.start()])
            start = space.end()
    return [part.strip() for part in [*found, tex[start:]] if part.strip()]


def depth(tex):
    """Number of braces, brackets and environments that are open at the end of a text."""
    opened = len(re.findall(r"(?<!\\)\{|\\begin\b|\\left\b|\\[bB]igg?l", tex))
    return opened - len(re.findall(r"(?<!\\)\}|\\end\b|\\right\b|\\[bB]igg?r", tex))


def picture(tex, glyphs, inline):
    """A formula as SVG: nothing to load and no font that a reader must have; its TeX is read by a screen reader. Its letters are put into `glyphs`,
    which a page has once.
    """
    svg = ziamath.Latex(tex, size=EM, color="currentColor", inline=inline).svgxml()
    width, height = (float(svg.attrib.pop(side)) / EM for side in ("width", "height"))
    # The base line is at 0.
    down = -height - float(svg.get("viewBox").split()[1]) / EM
    for symbol in svg.findall("{*}symbol"):
        glyphs.setdefault(symbol.get("id"), ElementTree.tostring(symbol, encoding="unicode"))
        svg.remove(symbol)
    svg.set("class", "math")
    svg.set("role", "img")
    svg.set("aria-label", PLACEHOLDER)
    svg.set("style", f"width:{width:.3f}em;height:{height:.3f}em;vertical-align:{down:.3f}em")
    # As numbers of characters: Markdown interprets some of TeX's as its own.
    label = "".join(character if character.isalnum() or character == " " else f"&#{ord(character)};" for character in " ".join(tex.split()))
    return ElementTree.tostring(svg, encoding="unicode").replace(PLACEHOLDER, label).replace("\n", " ")


if __name__ == "__main__":
    stage(Path(sys.argv[1]))
