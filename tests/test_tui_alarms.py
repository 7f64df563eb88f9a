"""The alarms: told once, kept until seen, counted when they come again; and when the bell rings."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from groundstation.messages import Severity
from groundstation.tui.alarms import CAUTION_KEPT_S, FLUTTER_S, RING_AGAIN_S, Alarms, Condition

ADVICE, CAUTION, ALARM = Severity.INFO, Severity.WARNING, Severity.ALARM
LINK = Condition("link", ALARM, "Link lost for 2 s.")
BATTERY = Condition("battery", CAUTION, "Battery at 29 %.")
GUARD = Condition("guard", ADVICE, "The guard acts.")

MILDER, WORSE = LINK._replace(severity=CAUTION), BATTERY._replace(severity=ALARM)
found = st.sets(st.sampled_from((LINK, BATTERY, GUARD, MILDER, WORSE)))


def keys(alarms: Alarms) -> list[str]:
    return [alarm.key for alarm in alarms.listed()]


def test_the_most_serious_is_told_first_and_advice_takes_no_line():
    alarms = Alarms()
    alarms.look([GUARD, BATTERY, LINK], 0.0)
    assert keys(alarms) == ["link", "battery", "guard"]
    assert alarms.first().key == "link"
    alarms.look([GUARD], 100.0)
    alarms.acknowledge()
    assert alarms.first() is None
    assert keys(alarms) == ["guard"]


def test_what_lasts_is_one_alarm_with_its_newest_words():
    alarms = Alarms()
    for step in range(50):
        alarms.look([LINK._replace(text=f"Link lost for {step} s.")], float(step))
    assert len(alarms.listed()) == 1
    assert alarms.first().text == "Link lost for 49 s."
    assert (alarms.first().count, alarms.first().began) == (1, 0.0)


def test_of_one_key_the_more_serious_counts():
    alarms = Alarms()
    alarms.look([LINK, LINK._replace(severity=CAUTION, text="silent")], 0.0)
    assert alarms.first().text == LINK.text


def test_an_alarm_that_is_over_stays_until_it_is_seen_a_caution_for_a_moment_advice_not():
    alarms = Alarms()
    alarms.look([LINK, BATTERY, GUARD], 0.0)
    alarms.look([], 1.0)
    assert keys(alarms) == ["link", "battery"]
    assert not alarms.first().active
    alarms.look([], 1.5 + CAUTION_KEPT_S)
    assert keys(alarms) == ["link"]
    alarms.look([], 1000.0)
    assert keys(alarms) == ["link"]
    assert alarms.acknowledge() == 1
    assert keys(alarms) == []


def test_what_is_seen_and_lasts_stays_listed_and_only_an_alarm_keeps_its_line():
    alarms = Alarms()
    alarms.look([LINK, BATTERY], 0.0)
    assert alarms.acknowledge() == 2
    alarms.look([LINK, BATTERY], 1.0)
    assert (alarms.first().key, alarms.first().seen) == ("link", True)
    alarms.look([BATTERY], 2.0)
    assert alarms.acknowledge() == 0
    assert alarms.first() is None
    assert keys(alarms) == ["battery"]


def test_what_becomes_worse_or_comes_back_later_is_told_anew_what_flutters_is_not():
    alarms = Alarms()
    alarms.look([BATTERY], 0.0)
    alarms.acknowledge()
    alarms.look([BATTERY._replace(severity=ALARM)], 1.0)
    assert not alarms.first().seen
    alarms.acknowledge()
    alarms.look([], 2.0)
    alarms.look([BATTERY._replace(severity=ALARM)], 3.0)
    assert (alarms.first().seen, alarms.first().count) == (True, 2)
    alarms.look([], 4.0)
    alarms.look([BATTERY], 4.5 + FLUTTER_S)
    assert not alarms.listed()[0].seen


def test_what_is_told_again_counts_again():
    alarms = Alarms()
    said = Condition("said", CAUTION, "Engage refused.", 10.0)
    alarms.look([said], 10.0)
    alarms.look([said], 10.5)
    alarms.look([said, said._replace(t=11.0)], 11.0)
    assert alarms.first().count == 2


def test_the_bell_rings_for_alarms_at_once_and_again_until_they_are_seen():
    alarms = Alarms()
    alarms.look([BATTERY, GUARD], 0.0)
    assert not alarms.ring(0.0)
    alarms.look([LINK], 1.0)
    assert alarms.ring(1.0)
    assert not alarms.ring(1.1)
    assert alarms.ring(1.0 + RING_AGAIN_S)
    alarms.acknowledge()
    assert not alarms.ring(100.0)


def test_the_bell_does_not_ring_for_what_is_over_nor_while_it_is_muted():
    alarms = Alarms()
    alarms.muted = True
    alarms.look([LINK], 0.0)
    assert not alarms.ring(0.0)
    alarms.muted = False
    assert not alarms.ring(0.1)
    assert alarms.ring(RING_AGAIN_S)
    alarms.look([], 4.0)
    assert not alarms.ring(100.0)


@given(st.lists(st.tuples(found, st.booleans(), st.floats(0.01, 20.0)), max_size=30))
def test_whatever_happens_all_that_lasts_is_listed_and_no_alarm_is_lost_unseen(moments):
    alarms, now, owed = Alarms(), 0.0, set()
    for conditions, acknowledged, passed in moments:
        now += passed
        alarms.look(conditions, now)
        listed = {alarm.key: alarm for alarm in alarms.listed()}
        told = {condition.key for condition in conditions if condition.severity is ALARM}
        owed |= {key for key in told if not listed[key].seen}
        assert {condition.key for condition in conditions} == {
            key for key, alarm in listed.items() if alarm.active
        }
        assert len(listed) == len(alarms.listed())
        assert owed <= set(listed)
        first = alarms.first()
        assert not owed or first.severity is ALARM
        if acknowledged:
            alarms.acknowledge()
            owed.clear()


def test_many_different_alarms_that_are_over_do_not_pile_up():
    alarms = Alarms()
    for number in range(500):
        alarms.look([Condition(f"said {number}", ALARM, "Something.")], float(number))
    assert len(alarms.listed()) <= 21
    assert alarms.listed()[0].key == "said 499"
