"""Many vehicles at once, and fast ones: the models' equations on NumPy rows or compiled, without a world."""
