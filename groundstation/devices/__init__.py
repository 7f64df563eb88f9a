"""Haptic devices as the program uses them: kept open, calibrated, listed, tried out, emulated."""
