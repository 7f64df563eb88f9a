"""Looks at recorded flights."""
