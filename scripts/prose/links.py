# SPDX-License-Identifier: MIT
"""Links of a page that lead nowhere: files that are not there, anchors that no heading has."""

import re
import urllib.parse

from prose.blocks import Finding
from prose.markdown import blocks, plain, without_code

TARGET = re.compile(r"""\]\(\s*<?([^()\s<>]+)>?(?:\s+["'][^)]*)?\)|(?:href|src)="([^"]+)\"""")
DEFINED = re.compile(r"\s*\[[^\]^]+\]:\s*<?([^\s>]+)")
NAMED = re.compile(r"""<a\s[^>]*(?:id|name)="([^"]+)\"""")
ELSEWHERE = re.compile(r"[a-zA-Z][a-zA-Z0-9+.-]+:|//")


def slug(heading):
    """The anchor that GitHub gives a heading's text."""
    text = plain(heading.replace("`", "")).strip().lower()
    return re.sub(r"[^\w\- ]", "", text).replace(" ", "-")


def anchors(text):
    """Anchors of a page."""
    found, count = set(), {}
    for block in blocks(text):
        if block.kind == "heading":
            name = slug(block.text)
            found.add(f"{name}-{count[name]}" if name in count else name)
            count[name] = count.get(name, 0) + 1
    return found | set(NAMED.findall(text))


def _targets(page):
    for block in page.blocks:
        if block.kind != "code":
            text = without_code(block.text)
            for match in (DEFINED if block.kind == "definition" else TARGET).finditer(text):
                yield block.line(match.start()), next(group for group in match.groups() if group)


class Links:
    """Checks links, and remembers the anchors of pages that they lead to."""

    def __init__(self):
        self._anchors = {}

    def _has(self, path, anchor):
        if path not in self._anchors:
            self._anchors[path] = anchors(path.read_text(encoding="utf-8"))
        return anchor in self._anchors[path]

    def check(self, page):
        """Findings of links to what is not there. Addresses of other machines are not tried."""
        for line, target in _targets(page):
            name, _, anchor = urllib.parse.unquote(target).partition("#")
            if ELSEWHERE.match(target):
                continue
            path = (page.file.parent / name).resolve() if name else page.file
            if not path.exists():
                yield Finding("link", page.path, line, f"link to {target}: there is no such file")
            elif anchor and path.suffix == ".md" and not self._has(path, anchor):
                yield Finding("link", page.path, line, f"link to {target}: there is no such heading")
