"""Drivers of haptic devices, one vendor a file, behind one contract (`device.py`)."""
