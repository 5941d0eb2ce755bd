# SPDX-License-Identifier: MIT
"""Sentences of a plain text."""

import re

# A mark, with what closes behind it, before a blank; dots of an ellipsis are none.
END = re.compile(r"""(?<!\.)[.?!](?!\.)["'”’)\]*_\s]*?(?=\s|$)""")
NEVER = (
    "e.g.",
    "i.e.",
    "cf.",
    "vs.",
    "al.",
    "approx.",
    "resp.",
    "fig.",
    "figs.",
    "eq.",
    "sec.",
    "dr.",
    "prof.",
)
BEFORE_NUMBERS = ("no.", "nos.", "p.", "pp.", "vol.", "ch.")
BEFORE_SMALL = ("etc.", "incl.", "ca.", "inc.")


def _goes_on(before, behind):
    """Whether the dot between both is an abbreviation's."""
    word = before.split()[-1].lstrip("([\"'*_").lower() if before.split() else ""
    following = behind.lstrip()[:1]
    return (
        word in NEVER
        or (word in BEFORE_NUMBERS and following.isdigit())
        or (word in BEFORE_SMALL and (following.islower() or following == ","))
    )


def sentences(text):
    """(position, text) of each sentence."""
    begin = 0
    for match in END.finditer(text):
        if not _goes_on(text[begin : match.start() + 1], text[match.end() :]):
            yield begin, text[begin : match.end()]
            begin = match.end()
    if text[begin:].strip():
        yield begin, text[begin:]


def words(text):
    """Words of a text: what blanks part and has a letter or a digit."""
    return [word for word in text.split() if any(letter.isalnum() for letter in word)]


def placed(block_text):
    """(position of the first word, words) of each sentence that has any."""
    for begin, sentence in sentences(block_text):
        own = words(sentence)
        if own:
            yield begin + sentence.index(own[0]), own
