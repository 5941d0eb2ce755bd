# SPDX-License-Identifier: MIT
"""Elements of HTML. Every text that is not Html is escaped where it gets into an element."""

import html
import re

from ..text_lines import visible, visible_json

VOID = ("img", "br")


class Html(str):
    """Markup, which is not escaped again."""


def markup(value):
    """Html of a value: markup as it is, lists joined, nothing for None, other values as visible text."""
    if isinstance(value, Html):
        return value
    if isinstance(value, (list, tuple)):
        return Html("".join(map(markup, value)))
    return Html("" if value is None else html.escape(visible(str(value))))


def element(name, /, *children, **attributes):
    """An element. An underscore behind the name of an attribute is left out, others become hyphens. True
    gives an attribute without a value, and False, None or an empty text none."""
    words = "".join(
        f" {key.rstrip('_').replace('_', '-')}" + ("" if value is True else f'="{markup(str(value))}"')
        for key, value in attributes.items()
        if value not in (None, "") and value is not False
    )
    return Html(f"<{name}{words}>{'' if name in VOID else markup(children) + f'</{name}>'}")


def breakable(value):
    """Html of a value. Its text, if it is one, may break between words that commas, equals signs, colons or underscores join."""
    if isinstance(value, (Html, list, tuple)):
        return markup(value)
    return Html(re.sub(r"([,=_:])(?=[^\s\d])", r"\1<wbr>", markup(value)))


def items(values):
    return element("ul", [element("li", value) for value in values])


def paragraphs(texts, style=None):
    return [element("p", text, class_=style) for text in texts]


def link(address, text=None):
    return element("a", address if text is None else text, href=address)


def data_element(name, json):
    """JSON for scripts, escaped so that no text in it can end the element or contain control characters."""
    escaped = visible_json(json).replace("<", "\\u003c")
    return Html(f'<script type="application/json" id="data-{name}">{escaped}</script>\n')


def script_element(script):
    script = script.replace("</script", "<\\/script").replace("<!--", "<\\!--")
    return Html(f"<script>\n{script}\n</script>\n")
