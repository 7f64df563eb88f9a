"""Record a session for the README: `python docs/pictures/session.py [FILE]`.

The real program in a pseudo-terminal, flown on the simulated vehicle by its keys; what the terminal shows becomes an
animated GIF. Needs rsvg-convert (Debian: librsvg2-bin).
"""

from __future__ import annotations

import io
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import pyte
from PIL import Image
from rich.console import Console
from rich.style import Style
from rich.text import Text

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

from terminal_svg import crisp  # noqa: E402

from bench.rig import Program, hovers  # noqa: E402
from groundstation.messages import Phase  # noqa: E402

COLUMNS, ROWS = 120, 40
WIDTH = 960
# A picture so often, shown so much faster.
EVERY_S, FASTER = 0.4, 3.0
COLOURS = 96
# What is pressed in the air, and how long it is flown on with it, s: round the crate, between balloon and column.
_AHEAD, _RIGHT, _LEFT = "\x1b[A", "\x1b[C", "\x1b[D"
FLIGHT = (
    (3 * _AHEAD + 2 * _LEFT, 2.6), (2 * _RIGHT, 2.4), ("v", 0.4), (3 * _RIGHT, 2.4), ("v", 0.4), (3 * _LEFT, 1.4),
    ("v", 0.4), (2 * _LEFT, 1.4), (2 * _RIGHT, 0.4), (" ", 2.0), ("v", 2.5), ("h", 1.0), ("l", 0.0),
)  # fmt: skip
# What the terminal itself is coloured, as in the dark theme.
_GROUND = "#0a0e14"


class Camera:
    """Takes pictures of a terminal."""

    def __init__(self) -> None:
        self._screen = pyte.Screen(COLUMNS, ROWS)
        self._stream = pyte.ByteStream(self._screen)
        self.frames: list[list[Text]] = []

    def take_in(self, data: bytes) -> None:
        """Show what the program wrote."""
        self._stream.feed(data)

    def wait(self, seconds: float) -> None:
        """Take pictures for a while."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.frames.append(self._picture())
            time.sleep(EVERY_S)

    def _picture(self) -> list[Text]:
        lines: list[Text] = []
        for row in range(ROWS):
            cells, line = self._screen.buffer[row], Text(end="")
            for column in range(COLUMNS):
                cell = cells[column]
                line.append(cell.data, _style(cell))
            lines.append(line)
        return lines


def _style(cell: pyte.screens.Char) -> Style:
    front, back = (_colour(name) for name in (cell.fg, cell.bg))
    if cell.reverse:
        front, back = back or _GROUND, front
    return Style(color=front, bgcolor=back or _GROUND, bold=cell.bold, italic=cell.italics)


def _colour(name: str) -> str | None:
    return None if name == "default" else f"#{name}" if len(name) == 6 else name


def fly(camera: Camera) -> None:
    """Fly from the ground to the ground."""
    with tempfile.TemporaryDirectory() as logs:
        program = Program(
            "--sim", "--mission", "paper", "--logs", logs, columns=COLUMNS, rows=ROWS, watch=camera.take_in
        )
        try:
            program.until(lambda view: view.status and view.status.health & 64, 30, "armable")
            for keys, condition, what in (
                ("A", lambda view: view.status.armed, "armed"),
                ("t", hovers, "hovering"),
                ("e", lambda view: view.pilot and view.pilot.phase == Phase.ENGAGED, "engaged"),
            ):
                camera.wait(0.8)
                program.type(keys)
                program.until(condition, 20, what)
            for keys, seconds in FLIGHT:
                program.type(keys)
                camera.wait(seconds)
            program.until(lambda view: not view.status.armed, 40, "landed")
            camera.wait(2.0)
        finally:
            program.close()


def image(lines: list[Text]) -> Image.Image:
    """Return a picture of a terminal."""
    console = Console(
        record=True, width=COLUMNS, file=io.StringIO(), legacy_windows=False, color_system="truecolor"
    )
    for line in lines:
        console.print(line, no_wrap=True, crop=True, soft_wrap=False)
    svg = crisp(console.export_svg(title="groundstation --sim --mission paper"))
    png = subprocess.run(
        ["rsvg-convert", "--width", str(WIDTH)], input=svg.encode(), stdout=subprocess.PIPE, check=True
    ).stdout
    return Image.open(io.BytesIO(png)).convert("RGB")


def _palette(images: list[Image.Image]) -> Image.Image:
    """Return the colours of all pictures: of some of them, side by side."""
    some = images[:: max(1, len(images) // 8)]
    sheet = Image.new("RGB", (WIDTH, sum(each.height for each in some)))
    for place, each in enumerate(some):
        sheet.paste(each, (0, place * each.height))
    return sheet.quantize(COLOURS, method=Image.Quantize.MAXCOVERAGE)


def main() -> None:
    """Make it."""
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "docs" / "images" / "session.gif"
    camera = Camera()
    fly(camera)
    images = [image(lines) for lines in camera.frames]
    palette = _palette(images)
    frames = [each.quantize(palette=palette, dither=Image.Dither.NONE) for each in images]
    frames[0].save(
        out,
        save_all=True,
        append_images=frames[1:],
        duration=round(1000 * EVERY_S / FASTER),
        loop=0,
        optimize=True,
    )
    print(out, f"{out.stat().st_size / 1e6:.1f} MB, {len(frames)} pictures")


if __name__ == "__main__":
    main()
