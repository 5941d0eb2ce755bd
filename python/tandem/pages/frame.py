# SPDX-License-Identifier: MIT
"""The frame of a page, with its parts and the navigation to them, and its figures."""

import dataclasses
import pathlib

from .markup import Html, data_element, element, link, markup, script_element

FOLDER = pathlib.Path(__file__).parent


@dataclasses.dataclass
class Section:
    """A part of a page. links: [(id, text)] of the navigation, the part itself unless given. is_hidden: until
    a script shows it."""

    anchor: str
    title: str
    content: object = ""
    links: list | None = None
    is_hidden: bool = False


@dataclasses.dataclass
class Page:
    """lead: what stands below the title. scripts: texts of scripts; a page without them has none. without: what
    readers without scripts are told. data: {id: JSON text} for scripts. has_images: the page shows image files
    beside it. style: rules of this page only."""

    title: str
    sections: list = dataclasses.field(default_factory=list)
    lead: object = ""
    footer: object = ""
    scripts: list = dataclasses.field(default_factory=list)
    without: str = "This page needs JavaScript for its charts and the scene. It is off in this browser."
    data: dict = dataclasses.field(default_factory=dict)
    has_images: bool = False
    style: str = ""


def figure(anchor, label, title, image, csv):
    """An image file with a heading above and a link to its numbers below. On a narrow screen it scrolls in a box of
    its own, so that its texts stay readable."""
    shown = element("img", src=image, alt=title)
    return element(
        "figure",
        element("h3", f"{label}: {title}"),
        element("div", shown, class_="scrolls", tabindex=0, role="group", aria_label=label),
        element("figcaption", link(csv)),
        id=anchor,
    )


def _section(part):
    heading = element("h2", part.title, id=f"{part.anchor}-title")
    return element(
        "section",
        heading,
        part.content,
        id=part.anchor,
        hidden=part.is_hidden,
        aria_labelledby=f"{part.anchor}-title",
    )


def _policy(page):
    """The Content-Security-Policy: no network, and scripts only if the page has some."""
    images = "'self'" if page.has_images else "data: blob:" if page.scripts else ""
    parts = ["default-src 'none'", "style-src 'unsafe-inline'"]
    parts += ["script-src 'unsafe-inline'"] if page.scripts else []
    return "; ".join([*parts, f"img-src {images}"] if images else parts)


def _links(sections):
    for part in sections:
        for anchor, text in [(part.anchor, part.title)] if part.links is None else part.links:
            yield element("a", text, href=f"#{anchor}", hidden=part.is_hidden)


def html_of(page):
    """The text of a page, which needs no network and no other file but its images."""
    elements = [data_element(*item) for item in page.data.items()]
    elements += map(script_element, page.scripts)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="{_policy(page)}">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>{markup(page.title)}</title>
<style>
{(FOLDER / "page.css").read_text(encoding="utf-8")}{page.style}</style>
</head>
<body>
<a class="skip" href="#main">Skip to the content</a>
<header>
<h1>{markup(page.title)}</h1>
{markup(page.lead)}
<nav aria-label="Parts of this page">{markup([*_links(page.sections)])}</nav>
</header>
<main id="main" tabindex="-1">
{element("noscript", element("p", page.without)) if page.scripts and page.without else ""}
{Html(chr(10)).join(map(_section, page.sections))}
</main>
<footer>{markup(page.footer)}</footer>
{"".join(elements)}</body>
</html>
"""


def own_script():
    """The script of the kit: elements, numbers and tables that sort."""
    return (FOLDER / "page.js").read_text(encoding="utf-8")
