"""Missions: what a flight is for and when it has succeeded."""
