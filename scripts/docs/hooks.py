"""What mkdocs does beyond its own: pages from texts that stand elsewhere in the repository, their links, and formulas as pictures."""

import posixpath
import re
from pathlib import Path
from xml.etree import ElementTree

import ziamath
from mkdocs.structure.files import File

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
SOURCES = {page: source for source, page in PAGES.items()}

# Left alone by the patterns below: what is code.
CODE = r"(?ms:^(?P<fence> *`{3,}).*?^(?P=fence)`* *$)|`[^`\n]+`"
LINK = re.compile(rf"{CODE}|(?P<text>\[[^\]\n]*\])\((?P<target>[^)\s]+)\)")
FORMULA = re.compile(rf"(?ms:^```math\n(?P<block>.*?)^```$)|{CODE}|(?<![\\$])\$(?P<inline>[^$\n]+)\$")
COMMENT = re.compile(rf"{CODE}|(?P<comment>(?s:<!--.*?-->)\n?)")

# Size of the text's letters in the pictures' own units.
EM = 20


def on_files(files, config):
    for source, page in PAGES.items():
        files.append(File.generated(config, page, content=(ROOT / source).read_text(encoding="utf-8")))
    return files


def on_page_markdown(markdown, page, config, files):
    page.formulas, page.glyphs = [], {}
    source = SOURCES.get(page.file.src_uri, f"docs/{page.file.src_uri}")
    # What follows a language is for other readers, as in rust,no_run.
    markdown = re.sub(r"^( *```\w+),\S*$", r"\1", markdown, flags=re.M)
    markdown = COMMENT.sub(lambda match: "" if match["comment"] else match[0], markdown)
    markdown = LINK.sub(lambda match: link(match, source, page.file.src_uri, files), markdown)
    return FORMULA.sub(lambda match: formula(match, page), markdown)


def on_page_content(content, page, config, files):
    if not page.formulas:
        return content
    content = re.sub(r"(?:<p>)?⟦(\d+)⟧(?:</p>)?", lambda match: page.formulas[int(match[1])], content)
    return f'{content}<svg class="glyphs" aria-hidden="true">{"".join(page.glyphs.values())}</svg>'


def link(match, source, page, files):
    """A link as the site has it: to a page, or plain text where what it leads to is not on the site."""
    target = match["target"]
    if target is None or re.match(r"[a-z]+:|#", target):
        return match[0]
    path, _, anchor = target.partition("#")
    place = posixpath.normpath(posixpath.join(posixpath.dirname(source), path))
    if not (ROOT / place).exists():
        # Left for mkdocs to complain about.
        return match[0]
    uri = PAGES.get(place, place.removeprefix("docs/"))
    if files.get_file_from_path(uri) is None:
        return match["text"][1:-1]
    relative = posixpath.relpath(uri, posixpath.dirname(page) or ".")
    return f"{match['text']}({relative}{'#' + anchor if anchor else ''})"


def formula(match, page):
    """A mark in the place of a formula, whose picture is put there when the page is made: Markdown would take it apart."""
    if match["block"] is not None:
        tex = match["block"].strip()
        number = re.search(r"\\tag\{([^}]*)\}", tex)
        tex = re.sub(r"\s*\\tag\{[^}]*\}", "", tex)
        pictures = "".join(f"<span>{picture(part, page.glyphs, inline=False)}</span>" for part in parts(tex))
        shown = f'<div class="number">({number[1]})</div>' if number else ""
        page.formulas.append(f'<div class="formula"><div class="parts">{pictures}</div>{shown}</div>')
    elif match["inline"] is not None:
        page.formulas.append(picture(match["inline"], page.glyphs, inline=True))
    else:
        return match[0]
    return f"⟦{len(page.formulas) - 1}⟧"


def parts(tex):
    """What stands beside each other in a formula with wide spaces between: parts that may stand below each other on a narrow page."""
    found, start = [], 0
    for space in re.finditer(r"\\q?quad\b", tex):
        before = tex[: space.start()]
        if depth(before) == 0 and before.rstrip().endswith((",", ";")):
            found.append(tex[start : space.start()])
            start = space.end()
    return [part.strip() for part in [*found, tex[start:]] if part.strip()]


def depth(tex):
    """How many braces, brackets and environments are open at the end of a text."""
    opened = len(re.findall(r"(?<!\\)\{|\\begin\b|\\left\b|\\[bB]igg?l", tex))
    return opened - len(re.findall(r"(?<!\\)\}|\\end\b|\\right\b|\\[bB]igg?r", tex))


def picture(tex, glyphs, inline):
    """A formula as SVG: nothing to load and no font that a reader must have; its TeX is what a screen reader says. Its letters are
    put into `glyphs`, which a page has once.
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
    svg.set("aria-label", tex)
    svg.set("style", f"width:{width:.3f}em;height:{height:.3f}em;vertical-align:{down:.3f}em")
    return ElementTree.tostring(svg, encoding="unicode")
