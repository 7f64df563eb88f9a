"""The line that tells how long work is going: changing on a terminal, a line for what is begun elsewhere."""

import io

import pytest

from groundstation.status_line import StatusLine


class Terminal(io.StringIO):
    def isatty(self):
        return True


def test_on_a_terminal_one_line_changes_and_is_gone_at_the_end():
    out, now = Terminal(), [0.0]
    with StatusLine(out, lambda: now[0]) as line:
        line.tell("reading")
        for now[0] in (0.0, 0.1, 0.25):
            line.step(f"at {now[0]}")
        line.note("This stays.")
    assert out.getvalue() == ("\r\x1b[Kreading\r\x1b[Kat 0.0\r\x1b[Kat 0.25\r\x1b[KThis stays.\n\r\x1b[K")


def test_elsewhere_what_is_begun_is_a_line_and_steps_are_none():
    out = io.StringIO()
    with StatusLine(out) as line:
        line.tell("reading")
        line.step("half of it")
        line.note("This stays.")
    assert out.getvalue() == "reading\nThis stays.\n"


def test_an_error_ends_the_line_too():
    out = Terminal()
    with pytest.raises(ValueError, match="no"), StatusLine(out):
        raise ValueError("no")
    assert out.getvalue() == "\r\x1b[K"
