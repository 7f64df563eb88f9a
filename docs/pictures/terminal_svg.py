"""Make Textual's SVG screenshots look like the terminal wherever they are shown.

The export positions runs of text and relies on a web font; viewers without it (and rsvg-convert, which also
ignores textLength) shift everything. Here words are placed one by one, and braille, blocks and box lines are
drawn as shapes.
"""

from __future__ import annotations

import html
import re
import unicodedata
from collections.abc import Iterator

# Geometry of Rich's export: a cell, and how far its top is above the text's baseline.
CELL_W, CELL_H, RISE = 12.2, 24.4, 18.5
_TEXT = re.compile(
    r'<text class="([^"]*)" x="([\d.]+)" y="([\d.]+)" textLength="[\d.]+"([^>]*)>([^<]*)</text>'
)
_FONT = re.compile(r"font-size: 20px;")
_FACES = re.compile(r"@font-face \{.*?\}\s*", re.DOTALL)
# Arms of box-drawing characters: up, right, down, left.
_LINES = {
    "│": "ud", "─": "rl", "╭": "rd", "╮": "dl", "╰": "ur", "╯": "ul", "┤": "udl", "├": "udr", "┼": "urdl",
    "╴": "l", "╶": "r", "╵": "u", "╷": "d", "┃": "UD", "━": "RL", "┏": "RD", "┓": "DL", "┗": "UR", "┛": "UL",
}  # fmt: skip
_EIGHTHS = " ▁▂▃▄▅▆▇█"
_HALVES = {"▌": (0.0, 0.5), "▐": (0.5, 1.0), "▎": (0.0, 0.25), "▊": (0.0, 0.75)}
# Bits of a braille cell's dots as (column, row).
_DOTS = ((0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (0, 3), (1, 3))


def crisp(svg: str) -> str:
    """Return the screenshot with every character where the terminal has it."""
    svg = _FACES.sub("", svg)
    svg = _FONT.sub(
        'font-size: 20.26px; font-family: "DejaVu Sans Mono", "Menlo", "Consolas", monospace;', svg
    )
    svg = svg.replace("font-family: Fira Code, monospace;", "")
    return _TEXT.sub(_run, svg)


def _run(match: re.Match[str]) -> str:
    style, x, y, rest, text = match.groups()
    text = html.unescape(text).replace("\xa0", " ")
    left, base = float(x), float(y)
    pieces: list[str] = []
    for start, word in _words(text):
        at = left + start * CELL_W
        width = sum(not unicodedata.combining(letter) for letter in word) * CELL_W
        where = f'x="{at:.1f}" y="{base:g}" textLength="{width:.1f}"{rest}'
        pieces.append(f'<text class="{style}" {where}>{html.escape(word)}</text>')
    shapes = "".join(
        _shape(letter, left + column * CELL_W, base - RISE)
        for column, letter in _cells(text)
        if _drawn(letter)
    )
    if shapes:
        pieces.append(f'<path class="{style}" d="{shapes}"/>')
    return "".join(pieces)


def _drawn(letter: str) -> bool:
    return letter in _LINES or letter in _EIGHTHS[1:] or letter in _HALVES or "\u2801" <= letter <= "\u28ff"


def _cells(text: str) -> Iterator[tuple[int, str]]:
    """Yield every character with its column; one that combines has the column of the one before it."""
    column = -1
    for letter in text:
        column += not unicodedata.combining(letter)
        yield column, letter


def _words(text: str) -> Iterator[tuple[int, str]]:
    """Yield what stays text, word by word with its column."""
    start, word = 0, ""
    for column, letter in _cells(f"{text} "):
        if letter != " " and not _drawn(letter):
            start = start if word else column
            word += letter
        elif word:
            yield start, word
            word = ""


def _shape(letter: str, x: float, y: float) -> str:
    if letter in _LINES:
        return _box_line(_LINES[letter], x, y)
    if letter in _HALVES:
        begin, end = _HALVES[letter]
        return _rectangle(x + begin * CELL_W, y, (end - begin) * CELL_W, CELL_H + 0.2)
    if letter in _EIGHTHS:
        height = _EIGHTHS.index(letter) / 8 * CELL_H
        return _rectangle(x, y + CELL_H - height, CELL_W + 0.2, height + 0.2)
    size, bits = 3.6, ord(letter) - 0x2800
    places = (dot for bit, dot in enumerate(_DOTS) if bits >> bit & 1)
    return "".join(
        _rectangle(
            x + (column + 0.5) * CELL_W / 2 - size / 2, y + (row + 0.5) * CELL_H / 4 - size / 2, size, size
        )
        for column, row in places
    )


def _box_line(arms: str, x: float, y: float) -> str:
    thick = 4.0 if arms.isupper() else 1.6
    middle_x, middle_y, half = x + CELL_W / 2, y + CELL_H / 2, thick / 2
    drawn = {
        "u": (middle_x - half, y, thick, CELL_H / 2 + half),
        "d": (middle_x - half, middle_y - half, thick, CELL_H / 2 + half),
        "l": (x, middle_y - half, CELL_W / 2 + half, thick),
        "r": (middle_x - half, middle_y - half, CELL_W / 2 + half, thick),
    }
    return "".join(_rectangle(*drawn[arm]) for arm in arms.lower())


def _rectangle(x: float, y: float, width: float, height: float) -> str:
    return f"M{x:.1f} {y:.1f}h{width:.1f}v{height:.1f}h-{width:.1f}z"
