"""The channel in virtual time: what it does to frames, what it never does, and how people ask for it."""

import itertools
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim.autopilot.parameters import SPECS, Parameters
from sim.channel import IDEAL, LATER_S, QUEUE_S, UNDER_WAY, Channel, Conditions
from sim.conditions import BothWays, ConditionsError, changed, parse_conditions, publish
from sim.process.framing import Splitter

STEP = 0.004


def passed(conditions, times, seed=0, size=10, until=60.0):
    """Send numbered frames at times; return (number, time sent, time arrived) in order of arrival."""
    channel = Channel(conditions, seed)
    waiting = list(enumerate(times))
    arrived = []
    for tick in range(round(until / STEP)):
        t = tick * STEP
        while waiting and waiting[0][1] <= t:
            number, _ = waiting.pop(0)
            channel.send(t, number.to_bytes(4, "little").ljust(size, b"."))
        arrived += [(int.from_bytes(data[:4], "little"), times[int.from_bytes(data[:4], "little")], t)
                    for data in channel.due(t)]  # fmt: skip
    assert channel.due(math.inf) == []
    return arrived


def every(interval, count, start=0.0):
    """Return times on the grid of steps."""
    return [round((start + place * interval) / STEP) * STEP for place in range(count)]


def crowd(count):
    """Return the times of a thousand frames a step."""
    return [number // 1000 * STEP for number in range(count)]


share = st.floats(0.0, 1.0)
conditions_of_all_kinds = st.builds(
    Conditions,
    delay=st.floats(0.0, 2.0),
    jitter=st.floats(0.0, 1.0),
    loss=share,
    burst=st.sampled_from((0.0, 1.0, 3.0, 50.0)),
    duplicate=share,
    reorder=share,
    rate=st.sampled_from((0.0, 500.0, 20_000.0)),
    blackouts=st.just(()),
)
sendings = st.lists(st.integers(0, 1000).map(lambda tick: tick * STEP), max_size=60).map(sorted)


def test_an_ideal_channel_is_no_channel():
    times = every(0.1, 20)
    assert [(number, at) for number, _, at in passed(IDEAL, times)] == list(enumerate(times))
    channel = Channel()
    assert channel.idle(0.0)
    channel.send(0.0, b"x")
    assert not channel.idle(0.0)
    channel.due(0.0)
    assert channel.idle(0.0)


@settings(max_examples=60, deadline=None)
@given(conditions=conditions_of_all_kinds, times=sendings)
def test_without_loss_and_limits_nothing_is_lost(conditions, times):
    conditions = conditions._replace(loss=0.0, rate=0.0, duplicate=0.0)
    arrived = passed(conditions, times, until=10.0)
    assert sorted(number for number, _, _ in arrived) == list(range(len(times)))


@settings(max_examples=60, deadline=None)
@given(conditions=conditions_of_all_kinds, times=sendings)
def test_without_reordering_the_order_stays(conditions, times):
    arrived = [number for number, _, _ in passed(conditions._replace(reorder=0.0), times, until=20.0)]
    assert arrived == sorted(arrived)


@settings(max_examples=60, deadline=None)
@given(conditions=conditions_of_all_kinds, times=sendings)
def test_nothing_comes_before_it_can_and_nothing_is_made_up(conditions, times):
    arrived = passed(conditions, times, until=20.0)
    least = max(0.0, conditions.delay - conditions.jitter)
    assert all(at >= sent + least - 1e-5 for _, sent, at in arrived)
    assert all(count <= 2 for count in _counts(arrived).values())


@settings(max_examples=60, deadline=None)
@given(conditions=conditions_of_all_kinds, times=sendings, seed=st.integers(0, 5))
def test_the_same_seed_does_the_same(conditions, times, seed):
    assert passed(conditions, times, seed, until=12.0) == passed(conditions, times, seed, until=12.0)


def test_another_seed_does_something_else():
    conditions = Conditions(loss=0.5)
    assert passed(conditions, every(0.1, 100), seed=1) != passed(conditions, every(0.1, 100), seed=2)


def _counts(arrived):
    counts = {}
    for number, _, _ in arrived:
        counts[number] = counts.get(number, 0) + 1
    return counts


def test_a_delay_of_one_step_is_one_step():
    """Rounding of virtual time does not make it two."""
    arrived = passed(Conditions(delay=STEP), every(STEP, 5000))
    assert {round((at - sent) / STEP) for _, sent, at in arrived} == {1}


def test_jitter_is_even_around_the_delay():
    """Frames sent further apart than the jitter is wide: each has its own delay, d ± j, of mean d and spread j/√3."""
    arrived = passed(Conditions(delay=0.2, jitter=0.05), every(0.12, 5000), until=620.0)
    delays = [at - sent for _, sent, at in arrived]
    mean = sum(delays) / len(delays)
    spread = math.sqrt(sum((delay - mean) ** 2 for delay in delays) / len(delays))
    # A frame is seen at the step after it is due: half a step later on average.
    assert mean == pytest.approx(0.2 + STEP / 2, abs=0.002)
    assert spread == pytest.approx(0.05 / math.sqrt(3), rel=0.05)
    assert 0.15 - 1e-6 <= min(delays) < 0.155
    assert 0.245 < max(delays) <= 0.25 + STEP


@pytest.mark.parametrize("loss", [0.05, 0.3, 0.9])
@pytest.mark.parametrize("burst", [0.0, 4.0])
def test_losses_have_the_share_and_the_length_asked_for(loss, burst):
    count = 40_000
    arrived = {number for number, _, _ in passed(Conditions(loss=loss, burst=burst), crowd(count), until=1.0)}
    lost = [number not in arrived for number in range(count)]
    lengths = [len(list(run)) for gone, run in itertools.groupby(lost) if gone]
    # With bursts the trials depend on each other: the share's spread grows with their length.
    expected = max(burst, loss / (1.0 - loss)) if burst else 1.0 / (1.0 - loss)
    assert sum(lost) / count == pytest.approx(loss, abs=0.025)
    assert sum(lengths) / len(lengths) == pytest.approx(expected, rel=0.1)


def test_all_can_be_lost():
    assert passed(Conditions(loss=1.0, burst=5.0), [0.0] * 1000, until=0.1) == []
    assert passed(Conditions(loss=1.0), [0.0] * 1000, until=0.1) == []


def test_duplicates_have_the_share_asked_for():
    arrived = passed(Conditions(duplicate=0.25), crowd(20_000), until=1.0)
    assert len(arrived) == pytest.approx(25_000, rel=0.02)


def test_what_is_out_of_order_comes_later_but_comes():
    arrived = passed(Conditions(delay=0.1, reorder=0.2), every(0.02, 1000))
    overtaken = [number for (number, _, _), (after, _, _) in itertools.pairwise(arrived) if after < number]
    assert len(overtaken) > 50
    late = [at - sent for _, sent, at in arrived]
    assert min(late) == pytest.approx(0.1, abs=1e-6)
    assert max(late) <= 0.1 + LATER_S + STEP
    assert sum(1 for delay in late if delay > 0.1 + STEP) / len(late) == pytest.approx(0.2, abs=0.04)


@settings(max_examples=40, deadline=None)
@given(times=sendings, rate=st.sampled_from((200.0, 1000.0, 7777.0)), size=st.integers(8, 280))
def test_no_more_than_the_rate_passes(times, rate, size):
    """Over any stretch of time: the bytes that passed are at most rate × time and one frame."""
    arrived = [at for _, _, at in passed(Conditions(rate=rate), times, size=size, until=10.0)]
    for first, last in itertools.combinations(range(len(arrived)), 2):
        carried = (last - first) * size
        assert carried <= rate * (arrived[last] - arrived[first] + STEP) + 1e-6


def test_a_rate_is_used_up_exactly():
    """Twice as much as fits: a second's worth waits, the rest is lost, and what arrives is the rate."""
    arrived = passed(Conditions(rate=1000.0), every(0.02, 1000), size=40)
    in_the_middle = [at for _, _, at in arrived if 5.0 < at <= 15.0]
    assert len(in_the_middle) * 40 == pytest.approx(10_000, abs=40)
    waits = [at - sent for _, sent, at in arrived if sent > 5.0]
    assert max(waits) <= QUEUE_S + 0.04 + STEP


def test_a_lost_frame_used_the_rate_all_the_same():
    arrived = passed(Conditions(rate=1000.0, loss=0.5), every(0.02, 1000), size=40)
    assert len([at for _, _, at in arrived if 5.0 < at <= 15.0]) == pytest.approx(125, abs=35)


def test_a_blackout_begins_and_ends():
    times = every(0.1, 100)
    arrived = passed(Conditions(delay=0.5, blackouts=((2.0, 3.0), (5.0, 5.5))), times)
    missing = {round(t, 1) for t in times} - {round(sent, 1) for _, sent, _ in arrived}
    assert missing == {2.0, 2.1, 2.2, 2.3, 2.4, 2.5, 2.6, 2.7, 2.8, 2.9, 5.0, 5.1, 5.2, 5.3, 5.4}


def test_a_blackout_from_now():
    channel = Channel()
    channel.black_out(2.0)
    assert not channel.idle(1.9)
    channel.send(1.9, b"lost")
    assert channel.due(10.0) == []
    assert channel.idle(2.0)
    channel.send(2.0, b"comes")
    assert channel.due(2.0) == [b"comes"]


def test_conditions_change_while_frames_are_under_way():
    """What is under way arrives as it would have, and what follows does not overtake it."""
    channel = Channel(Conditions(delay=1.0))
    channel.send(0.0, b"slow")
    channel.change(IDEAL)
    channel.send(0.5, b"fast")
    assert channel.due(0.9) == []
    assert channel.due(1.0) == [b"slow", b"fast"]


def test_losses_stop_when_told():
    channel = Channel(Conditions(loss=1.0, burst=10.0))
    channel.send(0.0, b"lost")
    channel.change(IDEAL)
    channel.send(0.0, b"comes")
    assert channel.due(0.0) == [b"comes"]


def test_memory_is_bounded():
    channel = Channel(Conditions(delay=5.0, duplicate=1.0))
    for _ in range(2 * UNDER_WAY):
        channel.send(0.0, b"x")
    assert len(channel._under_way) == UNDER_WAY


# Frames


@settings(max_examples=200, deadline=None)
@given(data=st.binary(max_size=400), cuts=st.lists(st.integers(0, 400)), whole=st.booleans())
def test_pieces_joined_are_the_input(data, cuts, whole):
    splitter = Splitter(whole=whole)
    edges = [0, *sorted(min(cut, len(data)) for cut in cuts), len(data)]
    joined = b""
    for begin, end in itertools.pairwise(edges):
        joined += b"".join(splitter.split(data[begin:end]))
    joined += b"".join(splitter.flush())
    assert joined == data


def frames():
    from pymavlink.dialects.v20 import common as m

    packer = m.MAVLink(None, srcSystem=1, srcComponent=1)
    messages = [
        m.MAVLink_heartbeat_message(2, 12, 0, 0, 3, 3),
        m.MAVLink_attitude_message(1, 0.1, 0.2, 0.3, 0, 0, 0),
        m.MAVLink_statustext_message(6, b"hello"),
    ]
    signer = m.MAVLink(None, srcSystem=1, srcComponent=1)
    signer.signing.secret_key, signer.signing.sign_outgoing = bytes(32), True
    yield from (bytes(message.pack(packer)) for message in messages)
    yield bytes(messages[0].pack(packer, force_mavlink1=True))
    yield bytes(messages[1].pack(signer))


def test_frames_are_found_in_datagrams_and_in_streams():
    ours = list(frames())
    assert list(Splitter(whole=True).split(b"".join(ours))) == ours
    splitter = Splitter(whole=False)
    assert [frame for byte in b"".join(ours) for frame in splitter.split(bytes([byte]))] == ours


def test_garbage_between_frames_stays_between_them():
    ours = list(frames())
    assert list(Splitter(whole=True).split(b"noise" + ours[0] + b"more" + ours[1])) == [
        b"noise",
        ours[0],
        b"more",
        ours[1],
    ]


# What people say


def test_conditions_are_parsed():
    both = parse_conditions("delay=0.15, jitter=.03,up.loss=0.05,down.rate=5000,down.delay=0.2,blackout=20+5")
    assert both.up == Conditions(delay=0.15, jitter=0.03, loss=0.05, blackouts=((20.0, 25.0),))
    assert both.down == Conditions(delay=0.2, jitter=0.03, rate=5000.0, blackouts=((20.0, 25.0),))
    assert parse_conditions("") == BothWays()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("dealy=1", "dealy: unknown; give delay, jitter"),
        ("sideways.delay=1", "sideways.delay: unknown"),
        ("delay", "delay: '' is not a number"),
        ("delay=fast", "delay=fast: 'fast' is not a number from 0 to "),
        ("delay=-1", "not a number from 0"),
        ("delay=nan", "not a number from 0"),
        ("delay=inf", "not a number from 0"),
        ("loss=5%", "loss=5%: '5%' is not a number from 0 to 0.95."),
        ("loss=1.5", "from 0 to 0.95."),
        ("burst=0.5", "shorter than a frame"),
        ("blackout=5", "blackout=5: is not a blackout; give START+LENGTH"),
        ("blackout=5+x", "'x' is not a number"),
    ],
)
def test_what_is_wrong_is_said(text, says):
    with pytest.raises(ConditionsError) as caught:
        parse_conditions(text)
    assert says in str(caught.value)


def test_parameters_and_conditions_say_the_same():
    parameters = Parameters()
    both = parse_conditions(
        "delay=0.5,jitter=0.25,loss=0.125,duplicate=0.5,reorder=0.25,rate=1024,burst=4,up.delay=1,blackout=1+2"
    )
    publish(both, parameters)
    assert parameters["SIM_UP_DELAY"] == 1.0
    assert parameters["SIM_DN_DELAY"] == 0.5
    assert changed(both, parameters) == both
    assert parameters.set("SIM_DN_LOSS", 0.75)
    assert changed(both, parameters) == both._replace(down=both.down._replace(loss=0.75))


@pytest.mark.parametrize("name", [name for name in SPECS if name.startswith(("SIM_UP_", "SIM_DN_"))])
def test_a_channel_is_ideal_unless_asked_otherwise(name):
    assert SPECS[name].default == 0.0
