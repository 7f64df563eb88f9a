"""The stick's keepalive: steady while the screen turns, silent when it hangs."""

import threading

from groundstation.tui.keepalive import SCREEN_STALL_S, Keepalive


class Clock:
    now = 50.0

    def __call__(self) -> float:
        return self.now


def test_it_is_due_until_the_screen_has_hung_for_too_long():
    clock = Clock()
    keepalive = Keepalive(lambda: None, clock)
    clock.now += SCREEN_STALL_S
    assert keepalive.due()
    clock.now += 0.001
    assert not keepalive.due()
    keepalive.turned()
    assert keepalive.due()


def test_it_sends_again_and_again_and_stops_for_good():
    sent, enough = [], threading.Event()

    def send() -> None:
        sent.append(1)
        if len(sent) == 3:
            enough.set()

    keepalive = Keepalive(send, Clock())
    keepalive.start()
    assert enough.wait(20)
    keepalive.stop()
    count = len(sent)
    assert not threading.Event().wait(0.1)
    assert len(sent) == count


def test_a_hung_screen_sends_nothing():
    clock, sent = Clock(), []
    keepalive = Keepalive(lambda: sent.append(1), clock)
    clock.now += 1.0
    keepalive.start()
    assert not threading.Event().wait(0.1)
    keepalive.stop()
    assert sent == []


def test_stopping_what_never_started_is_fine():
    Keepalive(lambda: None).stop()
