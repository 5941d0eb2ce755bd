# SPDX-License-Identifier: MIT
"""Shapes and texts of a drawing as SVG, with colours for light and dark pages."""

import xml.sax.saxutils

WIDTH, SHOWN = 520, 680  # in units of the drawing; in pixels where there is space
# Light and dark. Bodies and work have colours of Okabe and Ito (2008), which readers with colour blindness tell apart.
COLOURS = {
    "ground": ("#ffffff", "#14181d"),
    "text": ("#1b1f24", "#e6e9ec"),
    "quiet": ("#57606a", "#a2acb6"),
    "idle": ("#e4e7eb", "#2b323a"),
    "a": ("#0072b2", "#56b4e9"),
    "b": ("#d55e00", "#f0923a"),
    "test": ("#007a5a", "#2fd3a3"),
    "read": ("#8fd1bd", "#27806a"),
    "balance": ("#b0558a", "#d98abb"),
    "host": ("#f0c84a", "#c9a23a"),
    "ink": ("#1b1f24", "#14181d"),
}
SIZES = {"title": 20, "name": 18, "label": 15, "number": 13}
LETTER = 7.8  # width of one of a label, on average
BOLD = ("title", "name")


def number(value):
    """A coordinate with one decimal, in as few letters as possible."""
    return f"{value:.1f}".removesuffix(".0")


def at(x, y):
    return f"{number(x)} {number(y)}"


def polygon(points):
    return "M" + "L".join(at(*point) for point in points) + "z"


def line(*points):
    return "M" + "L".join(at(*point) for point in points)


def rectangle(box):
    return f"M{at(*box[:2])}H{number(box[2])}V{number(box[3])}H{number(box[0])}z"


class Drawing:
    """Elements in the order in which they are painted. name: of the file; ids begin with it, because a page may contain
    several drawings. about: what the drawing shows, for readers who do not see it."""

    def __init__(self, name, title, about):
        self.name, self.title, self.about = name, title, about
        self._elements, self._used = [], set()
        self.text(12, 30, title, "title")

    def _classes(self, **colours):
        used = {(kind, colour) for kind, colour in colours.items() if colour}
        self._used |= used
        return " ".join(f"drawing-{kind}-{colour}" for kind, colour in sorted(used))

    def path(self, parts, fill=None, stroke=None, width=None, opacity=None):
        """Parts of one path, each a text that this module makes. opacity: of the fill."""
        attributes = {
            "class": self._classes(fill=fill, stroke=stroke),
            "stroke-width": width,
            "fill-opacity": opacity,
        }
        words = "".join(f' {name}="{value}"' for name, value in attributes.items() if value is not None)
        self._elements.append(f'<path{words} d="{"".join(parts)}"/>')

    def text(self, x, y, words, size="label", fill="text", *, anchor="start"):
        classes = self._classes(fill=fill, size=size)
        end = "" if anchor == "start" else f' text-anchor="{anchor}"'
        self._elements.append(
            f'<text class="{classes}" x="{number(x)}" y="{number(y)}"{end}>{xml.sax.saxutils.escape(words)}</text>'
        )

    def subtitle(self, words, y=52, x=12):
        self.text(x, y, words, fill="quiet")

    def dots(self, points, radius):
        self._elements += [
            f'<circle class="{self._classes(fill="text")}" cx="{number(x)}" cy="{number(y)}" r="{number(radius)}"/>'
            for x, y in points
        ]

    def key(self, y, *entries):
        """A row of colours with their meanings: (colour, words)."""
        x = 12
        for colour, words in entries:
            self.path([rectangle((x, y - 11, x + 12, y + 1))], fill=colour)
            self.text(x + 17, y, words)
            x += 42 + LETTER * len(words)

    def use(self, place):
        """Paints the part of keep(). place: as in parts.moved()."""
        x, y, scale = place
        self._elements.append(
            f'<use href="#{self.name}-part" transform="translate({at(x, y)}) scale({scale:.3f})"/>'
        )

    def keep(self):
        """Makes what has been painted since the title a part for use()."""
        title, *part = self._elements
        self._elements = [title, f'<defs><g id="{self.name}-part">', *part, "</g></defs>"]

    def _rules(self, is_dark):
        for kind, what in sorted(self._used):
            if kind == "size":
                weight = ";font-weight:600" * (what in BOLD)
                rule = "" if is_dark else f"font-size:{SIZES[what]}px{weight}"
            else:
                rule = f"{kind}:{COLOURS[what][is_dark]}"
            if rule:
                yield f".drawing-{kind}-{what}{{{rule}}}"

    def svg(self, height):
        """The text of the drawing, which is so high."""
        ground = (
            f'<rect class="{self._classes(fill="ground")}" width="{WIDTH}" height="{number(height)}" rx="6"/>'
        )
        title, about = map(xml.sax.saxutils.escape, (self.title, self.about))
        size = f'width="{SHOWN}" height="{SHOWN * height / WIDTH:.0f}" viewBox="0 0 {WIDTH} {number(height)}"'
        names = f'role="img" aria-labelledby="{self.name}-title {self.name}-about"'
        return "\n".join(
            (
                f'<svg xmlns="http://www.w3.org/2000/svg" class="drawing" {size} {names}>',
                f'<title id="{self.name}-title">{title}</title>',
                f'<desc id="{self.name}-about">{about}</desc>',
                "<style>",
                ".drawing{font-family:sans-serif;fill:none;stroke-linejoin:round}",
                *self._rules(False),
                "@media (prefers-color-scheme:dark){",
                *self._rules(True),
                "}",
                "</style>",
                ground,
                *self._elements,
                "</svg>\n",
            )
        )
