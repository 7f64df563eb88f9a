"""Writes every flight to a Rerun recording."""
