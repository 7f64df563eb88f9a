"""Byte-level doubles of haptic devices, on a pty or a socket, each with a hand on it."""
