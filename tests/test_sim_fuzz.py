"""Hostile datagrams, the short form; the long one is `python -m bench fuzz`."""

import pytest

from bench.fuzz import MEMORY_BAR_MB, real, virtual


def test_twenty_thousand_hostile_datagrams_in_virtual_time():
    outcome = virtual(20_000, seed=1)
    assert outcome.datagrams >= 20_000
    assert outcome.reboots > 0
    assert outcome.flown > 1.0
    assert outcome.grown_mb < MEMORY_BAR_MB


@pytest.mark.flight
def test_two_thousand_hostile_datagrams_at_the_port():
    assert real(2_000, seed=2).grown_mb < MEMORY_BAR_MB
