"""Simulated operators fly missions as a trainee does, in virtual time and headless: a mission's par is measured."""
