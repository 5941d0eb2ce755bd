# SPDX-License-Identifier: MIT
"""Parts of pages that fold, and groups of them with a choice among the groups. Both work without scripts: a link
into a folded part opens it."""

import dataclasses
import pathlib

from .markup import element, link

SCRIPT = pathlib.Path(__file__).parent / "groups.js"


@dataclasses.dataclass(frozen=True)
class Group:
    """anchor: id of its content. name: what the choice calls it. count: how many it has. style: class of its
    name."""

    anchor: str
    name: str
    count: int
    content: object
    style: str = ""


def folded(anchor, summary, content, style=None):
    """A part that is closed at first. The id is inside of it, because browsers open what surrounds the target of a
    link."""
    inside = element("div", content, id=anchor)
    return element(
        "details", element("summary", element("span", summary, class_=style)), inside, class_="fold"
    )


def groups(label, anchor, parts):
    """Groups that fold, below a choice among them and all. `anchor`: id of the section that has all of them."""
    text = lambda name, count: f"{name} {count}"
    everything = link(f"#{anchor}", text("all", sum(part.count for part in parts)))
    links = [link(f"#{part.anchor}", text(part.name, part.count)) for part in parts]
    return [
        element("div", everything, links, class_="controls groups", role="group", aria_label=label),
        *(folded(part.anchor, text(part.name, part.count), part.content, part.style) for part in parts),
    ]


def groups_script():
    """The script that makes buttons of the choice."""
    return SCRIPT.read_text(encoding="utf-8")
