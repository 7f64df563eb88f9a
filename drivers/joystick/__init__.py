"""Joysticks and gamepads, by SDL 2: dual sticks and flight sticks, with force, rumble, or neither."""
