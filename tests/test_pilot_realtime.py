import os
import sys

import pytest

from groundstation.messages import EVENT_TEXT
from groundstation.pilot import realtime


def deny(*_: object) -> None:
    raise PermissionError


@pytest.mark.skipif(sys.platform != "linux", reason="real-time priority is asked for on Linux only")
def test_a_system_that_denies_it_is_met_with_a_sentence_on_how_to_grant_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(os, "sched_setscheduler", deny)
    words = realtime.request_realtime()
    assert "sudo setcap cap_sys_nice+ep /" in words
    assert "rtprio 50" in words
    assert len(words.encode()) < EVENT_TEXT


def test_elsewhere_it_says_that_it_cannot_ask(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "platform", "darwin")
    assert "on Linux only" in realtime.request_realtime()
