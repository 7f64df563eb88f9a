"""Text from outside, made fit for a terminal: what would move its cursor, or worse, becomes a question mark."""

from __future__ import annotations


def shown(text: str) -> str:
    """Return text in which nothing but letters, signs, spaces and lines is left."""
    return "".join(letter if letter.isprintable() or letter in "\n\t" else "?" for letter in text)
