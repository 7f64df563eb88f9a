"""The screen's memory: what is gone is given back, and at no moment does looking for it hold up the stick.

A full collection looks through every object and holds the interpreter meanwhile: 0.2 s with all the modules, and a
stick is stale after 0.1 s. So what is there when the flight is first shown is never looked through again, full
collections come at set times, and what they look through then is what came since: some milliseconds.
"""

from __future__ import annotations

import gc
import sys

from textual._styles_cache import StylesCache  # pyright: ignore[reportPrivateUsage]

from groundstation import heap

# How often it is tidied, s: what a page that was closed since has left, the next one takes again.
TIDY_S = 10.0
# Painting may not keep the stick's thread waiting: it asks for its turn and gets it within a millisecond.
_SWITCH_S = 0.001
# The young objects of some thousand frames are looked through before the old are, and all only when it is tidied.
_THRESHOLDS = (2_000, 20, 100_000)


def settle() -> None:
    """Take what there is for what stays."""
    heap.take_small_blocks()
    gc.collect()
    gc.freeze()
    gc.set_threshold(*_THRESHOLDS)
    sys.setswitchinterval(_SWITCH_S)


def tidy() -> None:
    """Give back what pages and messages that are gone have left.

    Textual 8.2 remembers 1,024 pairs of colours by the widget that asked (`lru_cache` on a method), and with a widget
    that is gone every line it painted: 30 MB in half an hour of opening pages.
    """
    StylesCache.get_inner_outer.cache_clear()
    gc.collect()
    heap.give_back()


def leave() -> None:
    """Let what was taken to stay be collected, when the screen has gone: another may follow it."""
    gc.unfreeze()
