"""A viewer that runs already is found by its address, or the flight does not start: it would never find it later."""

from __future__ import annotations

import socket

import pytest

from groundstation.errors import InputError
from groundstation.recording.live import find_viewer, free_tcp_port


@pytest.fixture
def port():
    with socket.socket() as listener:
        listener.bind(("127.0.0.1", 0))
        listener.listen()
        yield listener.getsockname()[1]


@pytest.mark.parametrize("form", ["127.0.0.1:{}", "rerun+http://127.0.0.1:{}/proxy", "rerun://127.0.0.1:{}/"])
def test_a_viewer_that_runs_is_found_by_any_form_of_its_address(port, form):
    assert find_viewer(form.format(port)) == f"rerun+http://127.0.0.1:{port}/proxy"


@pytest.mark.parametrize(
    "words", ["", "127.0.0.1:0", "127.0.0.1:65536", "http://x:80", "a b", "host:port", "x:1/y"]
)
def test_what_is_no_address_is_said_with_one_that_is(words):
    with pytest.raises(InputError, match=r"is no address; use HOST:PORT, such as 127\.0\.0\.1:9876"):
        find_viewer(words)


def test_where_nothing_answers_it_is_said_how_to_start_one():
    with pytest.raises(InputError, match="nothing answers there .*rerun --bind"):
        find_viewer(f"127.0.0.1:{free_tcp_port()}")


def test_a_host_that_is_not_known_is_said_in_the_same_words():
    with pytest.raises(InputError, match="nothing answers there"):
        find_viewer("no-such-host.invalid")
