"""Flies many flights in virtual time and compares them."""
