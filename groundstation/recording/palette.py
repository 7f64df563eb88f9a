"""The colours of a recording: Okabe and Ito's, made for all kinds of colour vision."""

from __future__ import annotations

from groundstation.recording.lanes import Tone

Colour = tuple[int, int, int]

ORANGE: Colour = (230, 159, 0)
SKY: Colour = (86, 180, 233)
GREEN: Colour = (0, 158, 115)
YELLOW: Colour = (240, 228, 66)
BLUE: Colour = (0, 114, 178)
VERMILION: Colour = (213, 94, 0)
PURPLE: Colour = (204, 121, 167)
GREY: Colour = (110, 110, 118)
LIGHT: Colour = (222, 222, 226)

# By part of a row: x, y, z, yaw.
PARTS: tuple[Colour, ...] = (ORANGE, SKY, GREEN, PURPLE)
REFERENCE, EXECUTED = ORANGE, SKY
VEHICLE, HAND, FORCE = SKY, ORANGE, YELLOW

TONES: dict[Tone, Colour] = {
    Tone.IDLE: GREY,
    Tone.WORKING: BLUE,
    Tone.GOOD: GREEN,
    Tone.WARNING: ORANGE,
    Tone.FAULT: VERMILION,
}
