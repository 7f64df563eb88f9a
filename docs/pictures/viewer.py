"""Take docs/images/viewer.png: a recording as the Rerun viewer opens it.

    python docs/pictures/viewer.py RECORDING.rrd [--at SECONDS] [--out FILE.png]

Needs no display, but a Vulkan driver (Debian: mesa-vulkan-drivers, libvulkan1).
"""

from __future__ import annotations

import argparse
from pathlib import Path

from headless_viewer import HeadlessViewer
from PIL import Image

BAR_POINTS = 36
PICTURE = Path(__file__).resolve().parents[1] / "images" / "viewer.png"

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("recording", type=Path)
parser.add_argument("--at", type=float, help="moment of the flight, s (default: three quarters of it)")
parser.add_argument("--tab", type=int, default=0, help="which tabs are in front (0 is the first)")
parser.add_argument("--view", help="show this one view (its name's beginning) instead of the whole window")
parser.add_argument("--size", default="1920x1080", help="of the window, points")
parser.add_argument("--out", type=Path, default=PICTURE)
asked = parser.parse_args()
if not asked.recording.is_file():
    parser.error(f"{asked.recording}: there is no such recording")

with HeadlessViewer(asked.size) as viewer:
    viewer.open(asked.recording)
    viewer.go_to(asked.at)
    viewer.turn_tabs(asked.tab)
    viewer.picture(asked.out, asked.view)
    for complaint in viewer.complaints():
        print(complaint)
if asked.view is None:
    # The window's own bar says which machine made the picture.
    with Image.open(asked.out) as picture:
        picture.crop((0, BAR_POINTS, *picture.size)).save(asked.out, optimize=True)
print(asked.out)
