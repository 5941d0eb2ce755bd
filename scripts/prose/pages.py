# SPDX-License-Identifier: MIT
"""Rules of a page: mean and longest sentence, size, sentences that begin with "Of"."""

import statistics

from prose.blocks import Finding
from prose.markdown import plain
from prose.sentences import placed, words

LONGEST = 35  # words in a sentence
MEAN, MEAN_OF_README = 20, 18
# Lines and words.
PAGE, README, ROOM_README = (150, 2500), (150, 1800), (80, 1000)


def is_room_readme(path):
    """Whether the page is a README of a source folder."""
    folders = path.split("/")[:-1]
    return path.endswith("README.md") and bool(folders) and folders[0] not in ("docs", "results")


def _sentences(page):
    """(line, words, how it begins) of each sentence of prose."""
    for block in page.blocks:
        if block.kind == "prose":
            for position, own in placed(plain(block.text)):
                yield block.line(position), own, beginning(block.text[position:])


def beginning(text):
    """The first words of a sentence, for a message."""
    return f"{' '.join(text[:60].split())[:40].rstrip()} ..."


def mean(page):
    """A finding where the page's sentences are too long on average."""
    lengths = [len(own) for _, own, _ in _sentences(page)]
    limit = MEAN_OF_README if page.path == "README.md" else MEAN
    if lengths and statistics.mean(lengths) > limit:
        yield Finding(
            "mean",
            page.path,
            1,
            f"mean sentence of {statistics.mean(lengths):.1f} words in {len(lengths)} sentences (at most {limit})",
        )


def long(page):
    """Findings of sentences that are too long."""
    for line, own, begin in _sentences(page):
        if len(own) > LONGEST:
            yield Finding(
                "long", page.path, line, f"sentence of {len(own)} words (at most {LONGEST}): {begin}"
            )


def size(page):
    """Findings of a page that is too long."""
    lines, count = len(page.text.splitlines()), len(page.text.split())
    most_lines, most_words = (
        README if page.path == "README.md" else ROOM_README if is_room_readme(page.path) else PAGE
    )
    if lines > most_lines:
        yield Finding("size", page.path, 1, f"{lines} lines (at most {most_lines})")
    if count > most_words:
        yield Finding("size", page.path, 1, f"{count} words (at most {most_words})")


def of(page):
    """Findings of sentences and headings that begin with "Of"."""
    for block in page.blocks:
        if block.kind in ("prose", "heading"):
            for position, own in placed(plain(block.text)):
                if own[0].strip("*_([\"'") == "Of":
                    yield Finding(
                        "of",
                        page.path,
                        block.line(position),
                        f"a sentence begins with Of: {beginning(block.text[position:])}",
                    )
