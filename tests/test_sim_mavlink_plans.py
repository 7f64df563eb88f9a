"""Missions, fences and rally points: up, down, refused, interrupted, and flown."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink.dialects.v20 import common as m
from sim_wire import DT, NAN, Wire

from sim import frames
from sim.autopilot.modes import Mode
from sim.autopilot.plan import Circle, Polygon
from sim.mavlink.items import Item, ItemError
from sim.mavlink.legs import leg, legs
from sim.mavlink.plans import RETRY_S, TIMEOUT_S
from sim.mavlink.zones import zones

MISSION, FENCE, RALLY = m.MAV_MISSION_TYPE_MISSION, m.MAV_MISSION_TYPE_FENCE, m.MAV_MISSION_TYPE_RALLY
RELATIVE = m.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT


def place(east, north):
    latitude, longitude, _ = frames.geodetic(east, north, 0.0)
    return round(latitude * 1e7), round(longitude * 1e7)


def waypoint(
    seq, east, north, height=5.0, command=m.MAV_CMD_NAV_WAYPOINT, params=(0.0, 0.0, 0.0, NAN), kind=MISSION
):
    x, y = place(east, north)
    return m.MAVLink_mission_item_int_message(
        1, 1, seq, RELATIVE, command, seq == 0, 1, *params, x, y, height, kind
    )


def bare(seq, command, *params):
    """An item without a place."""
    params = [*params, *[0.0] * (4 - len(params))]
    return m.MAVLink_mission_item_int_message(
        1, 1, seq, m.MAV_FRAME_MISSION, command, 0, 1, *params, 0, 0, 0.0
    )


class Planner(Wire):
    """A ground station that plans."""

    def upload(self, items, kind=MISSION, link=0):
        """Upload as asked; return the acknowledgement."""
        self.send(m.MAVLink_mission_count_message(1, 1, len(items), kind), link)
        for _ in range(10 * len(items) + 10):
            for message in self.run(DT):
                if message.get_type() == "MISSION_ACK":
                    return message
                if message.get_type() == "MISSION_REQUEST_INT":
                    assert message.mission_type == kind
                    self.send(items[message.seq], link)
        pytest.fail("no end of it")

    def download(self, kind=MISSION, ask=m.MAVLink_mission_request_int_message, answer="MISSION_ITEM_INT"):
        count = self.ask(m.MAVLink_mission_request_list_message(1, 1, kind), "MISSION_COUNT")
        assert count.mission_type == kind
        return [self.ask(ask(1, 1, seq, kind), answer) for seq in range(count.count)]


def payload(message):
    """Return what an item says, without the addresses and the mark of the current one."""
    return [
        getattr(message, name)
        for name in message.get_fieldnames()
        if name not in ("target_system", "target_component", "current")
    ]


def opaque_id(message):
    """Return the newest field, which pymavlink does not know: the last four bytes, zeros cut off."""
    length = {"MISSION_ACK": 4, "MISSION_COUNT": 5}[message.get_type()]
    data = bytes(message.get_msgbuf())
    return int.from_bytes(data[10 + length : 10 + data[1]].ljust(4, b"\0"), "little")


def a_fence():
    corners = [(-50, -50), (50, -50), (50, 50), (-50, 50)]
    command = m.MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION
    items = [
        waypoint(seq, *corner, command=command, params=(4.0, 0, 0, 0), kind=FENCE)
        for seq, corner in enumerate(corners)
    ]
    circle = m.MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION
    return [*items, waypoint(4, 20, 20, command=circle, params=(5.0, 0, 0, 0), kind=FENCE)]


def test_a_mission_comes_back_bit_for_bit():
    wire = Planner()
    items = [
        waypoint(0, 0, 0, 5.1, m.MAV_CMD_NAV_TAKEOFF),
        waypoint(1, 10.123, -4.5, 5.25, params=(1.5, 0.3, 0.0, 90.0)),
        m.MAVLink_mission_item_int_message(
            1, 1, 2, m.MAV_FRAME_MISSION, m.MAV_CMD_DO_CHANGE_SPEED, 0, 0, 1, 3.3, -1, 0, 7, -9, 0.1
        ),
        waypoint(3, 0, 0, 0.0, m.MAV_CMD_NAV_LAND),
    ]
    assert wire.upload(items).type == m.MAV_MISSION_ACCEPTED
    assert [payload(item)[:5] for item in wire.download()] == [payload(item)[:5] for item in items]
    ours = [item.pack(wire.packer) for item in items]
    back = [item.get_msgbuf() for item in wire.download()]
    # Floats as the wire has them: from the seventh byte of the payload (after two ids, sequence and so on).
    assert [bytes(a[10:38]) for a in back] == [b[10:38] for b in ours]
    assert [entry.current for entry in wire.download()] == [1, 0, 0, 0]


def test_fence_and_rally_points_too_and_nothing_is_mixed_up():
    wire = Planner()
    rally = [waypoint(0, 30, 30, 20.0, m.MAV_CMD_NAV_RALLY_POINT, (0, 0, 0, 0), RALLY)]
    assert wire.upload(a_fence(), FENCE).type == m.MAV_MISSION_ACCEPTED
    assert wire.upload(rally, RALLY).type == m.MAV_MISSION_ACCEPTED
    assert [payload(item) for item in wire.download(FENCE)] == [payload(item) for item in a_fence()]
    assert len(wire.download(RALLY)) == 1
    assert wire.download(MISSION) == []
    polygon, circle = wire.sim.autopilot.plan.fence
    assert isinstance(polygon, Polygon)
    assert polygon.inclusion
    assert polygon.corners[2] == pytest.approx((50, 50), abs=0.02)
    assert isinstance(circle, Circle)
    assert (circle.inclusion, circle.radius) == (False, 5.0)
    assert wire.sim.autopilot.plan.rally[0] == pytest.approx((30, 30, 20), abs=0.02)
    wire.send(m.MAVLink_mission_clear_all_message(1, 1, m.MAV_MISSION_TYPE_ALL))
    wire.run(DT)
    assert wire.newest("MISSION_ACK").type == m.MAV_MISSION_ACCEPTED
    assert wire.download(FENCE) == wire.download(RALLY) == []
    assert wire.sim.autopilot.plan.fence == ()


def test_a_plan_has_a_name_that_changes_with_it():
    wire = Planner()
    first = opaque_id(wire.upload([waypoint(0, 10, 0)]))
    assert first != 0
    count = wire.ask(m.MAVLink_mission_request_list_message(1, 1, MISSION), "MISSION_COUNT")
    assert opaque_id(count) == first
    assert opaque_id(wire.upload([waypoint(0, 10, 0)])) == first
    assert opaque_id(wire.upload([waypoint(0, 11, 0)])) not in (0, first)
    assert opaque_id(wire.upload([])) == 0


@pytest.mark.parametrize(
    ("items", "kind", "result"),
    [
        ([waypoint(0, 0, 0, command=m.MAV_CMD_DO_ORBIT)], MISSION, m.MAV_MISSION_UNSUPPORTED),
        ([waypoint(0, 0, 0, params=(float("inf"), 0, 0, 0))], MISSION, m.MAV_MISSION_INVALID_PARAM1),
        ([waypoint(0, 0, 0, params=(0, 0, 0, float("inf")))], MISSION, m.MAV_MISSION_INVALID_PARAM4),
        ([waypoint(0, 0, 0, height=3e38)], MISSION, m.MAV_MISSION_INVALID_PARAM7),
        (
            [
                m.MAVLink_mission_item_int_message(
                    1, 1, 0, RELATIVE, 16, 0, 1, 0, 0, 0, 0, 2_000_000_000, 0, 5
                )
            ],
            MISSION,
            m.MAV_MISSION_INVALID_PARAM5_X,
        ),
        (
            [m.MAVLink_mission_item_int_message(1, 1, 0, 1, 16, 0, 1, 0, 0, 0, 0, 0, 0, 5)],
            MISSION,
            m.MAV_MISSION_UNSUPPORTED_FRAME,
        ),
        (
            [waypoint(0, 0, 0), bare(1, m.MAV_CMD_DO_JUMP, 7, 1)],
            MISSION,
            m.MAV_MISSION_INVALID_PARAM1,
        ),
        (a_fence()[:2], FENCE, m.MAV_MISSION_INVALID_PARAM1),
        ([waypoint(0, 0, 0, kind=FENCE)], FENCE, m.MAV_MISSION_UNSUPPORTED),
        ([waypoint(0, 0, 0, kind=RALLY)], RALLY, m.MAV_MISSION_UNSUPPORTED),
    ],
)
def test_what_cannot_be_flown_is_refused_with_its_reason_and_the_old_plan_stays(items, kind, result):
    wire = Planner()
    old = a_fence() if kind == FENCE else [waypoint(0, 9, 9)]
    if kind == RALLY:
        old = [waypoint(0, 9, 9, 9.0, m.MAV_CMD_NAV_RALLY_POINT, (0, 0, 0, 0), RALLY)]
    assert wire.upload(old, kind).type == m.MAV_MISSION_ACCEPTED
    before = wire.sim.autopilot.plan
    assert wire.upload(items, kind).type == result
    wire.run(DT)
    assert any(text.startswith("Plan refused: ") for text in wire.texts())
    assert wire.sim.autopilot.plan == before
    assert len(wire.download(kind)) == len(old)


def test_too_much_and_unknown_kinds_are_refused():
    wire = Planner()
    for count, kind, result in ((2001, MISSION, m.MAV_MISSION_NO_SPACE), (1, 9, m.MAV_MISSION_UNSUPPORTED)):
        ack = wire.ask(m.MAVLink_mission_count_message(1, 1, count, kind), "MISSION_ACK")
        assert (ack.type, ack.mission_type) == (result, kind)
    ack = wire.ask(m.MAVLink_mission_request_int_message(1, 1, 0, MISSION), "MISSION_ACK")
    assert ack.type == m.MAV_MISSION_INVALID_SEQUENCE


def test_a_lost_item_is_asked_for_again_in_the_other_form_and_then_given_up():
    wire = Planner()
    wire.send(m.MAVLink_mission_count_message(1, 1, 2, MISSION))
    heard = [message.get_type() for message in wire.run(RETRY_S + 3 * DT)]
    assert heard.count("MISSION_REQUEST_INT") == 1
    assert heard.count("MISSION_REQUEST") == 1
    wire.run(TIMEOUT_S)
    assert "Plan upload timed out; the old plan stays" in wire.texts()
    assert not any(message.get_type().startswith("MISSION_REQ") for message in wire.run(1.0))
    assert wire.upload([waypoint(0, 5, 5)]).type == m.MAV_MISSION_ACCEPTED


def test_an_old_client_that_knows_only_floats_is_served():
    wire = Planner()
    wire.send(m.MAVLink_mission_count_message(1, 1, 1, MISSION))
    wire.run(DT)
    wire.send(m.MAVLink_mission_ack_message(1, 1, m.MAV_MISSION_UNSUPPORTED, MISSION))
    assert any(message.get_type() == "MISSION_REQUEST" for message in wire.run(DT))
    latitude, longitude, _ = frames.geodetic(20.0, 30.0, 0.0)
    item = m.MAVLink_mission_item_message(1, 1, 0, 3, 16, 1, 1, 0, 0, 0, 0, latitude, longitude, 7.0)
    assert wire.ask(item, "MISSION_ACK").type == m.MAV_MISSION_ACCEPTED
    (back,) = wire.download(ask=m.MAVLink_mission_request_message, answer="MISSION_ITEM")
    assert (back.x, back.y, back.z) == (item.x, item.y, 7.0) or (
        back.x == pytest.approx(latitude, abs=1e-5) and back.frame == 3
    )
    # A float has 24 bits: of a latitude half a metre is left.
    assert wire.sim.autopilot.plan.mission[0].position == pytest.approx((20.0, 30.0, 7.0), abs=0.5)


def test_duplicates_strangers_and_a_lost_end():
    wire = Planner()
    items = [waypoint(0, 5, 5), waypoint(1, 6, 6)]
    wire.send(m.MAVLink_mission_count_message(1, 1, 2, MISSION))
    wire.send(items[1])
    wire.send(items[0])
    wire.send(items[0])
    stranger = m.MAVLink(None, srcSystem=7, srcComponent=7)
    wire.endpoint.receive(waypoint(1, 99, 99).pack(stranger))
    wire.endpoint.receive(m.MAVLink_mission_count_message(1, 1, 1, MISSION).pack(stranger))
    acks = [message for message in wire.run(DT) if message.get_type() == "MISSION_ACK"]
    assert [(ack.target_system, ack.type) for ack in acks] == [(7, m.MAV_MISSION_ERROR)]
    wire.send(items[1])
    wire.send(items[1])
    acks = [message.type for message in wire.run(DT) if message.get_type() == "MISSION_ACK"]
    assert acks == [m.MAV_MISSION_ACCEPTED] * 2
    assert len(wire.download()) == 2


def test_a_cancelled_upload_is_over():
    wire = Planner()
    wire.send(m.MAVLink_mission_count_message(1, 1, 2, MISSION))
    wire.send(m.MAVLink_mission_ack_message(1, 1, m.MAV_MISSION_OPERATION_CANCELLED, MISSION))
    wire.run(TIMEOUT_S + 1)
    assert wire.texts() == []


def test_a_mission_is_flown_and_told():
    wire = Planner()
    items = [
        waypoint(0, 0, 0, 4.0, m.MAV_CMD_NAV_TAKEOFF),
        waypoint(1, 8, 0, 4.0),
        waypoint(2, 8, 6, 5.0),
        m.MAVLink_mission_item_int_message(1, 1, 3, m.MAV_FRAME_MISSION, 20, 0, 1, 0, 0, 0, 0, 0, 0, 0),
    ]
    assert wire.upload(items).type == m.MAV_MISSION_ACCEPTED
    assert wire.command(m.MAV_CMD_MISSION_START, 0, 0) == m.MAV_RESULT_ACCEPTED
    assert wire.sim.autopilot.armed
    wire.run(2)
    assert wire.newest("HEARTBEAT").custom_mode == 4 << 16 | 4 << 24
    assert wire.newest("MISSION_CURRENT").mission_state == m.MISSION_STATE_ACTIVE
    wire.run(90)
    assert not wire.sim.autopilot.armed
    reached = [message.seq for message in wire.heard if message.get_type() == "MISSION_ITEM_REACHED"]
    assert sorted(set(reached)) == [0, 1, 2, 3] or sorted(set(reached)) == [0, 1, 2]
    current = [message.seq for message in wire.heard if message.get_type() == "MISSION_CURRENT"]
    assert current == sorted(current)
    assert {message.total for message in wire.heard if message.get_type() == "MISSION_CURRENT"} == {4}


def test_a_mission_can_be_left_and_taken_up_at_another_item():
    wire = Planner()
    wire.upload([waypoint(0, 0, 0, 4.0, m.MAV_CMD_NAV_TAKEOFF), waypoint(1, 20, 0), waypoint(2, 0, 20)])
    wire.command(m.MAV_CMD_MISSION_START, 0, 0)
    wire.run(8)
    assert wire.command(m.MAV_CMD_DO_PAUSE_CONTINUE, 0) == m.MAV_RESULT_ACCEPTED
    assert wire.sim.autopilot.mode is Mode.HOLD
    wire.run(1.1)
    assert wire.newest("MISSION_CURRENT").mission_state == m.MISSION_STATE_PAUSED
    assert wire.command(m.MAV_CMD_DO_SET_MISSION_CURRENT, 9) == m.MAV_RESULT_DENIED
    assert wire.command(m.MAV_CMD_DO_SET_MISSION_CURRENT, 2) == m.MAV_RESULT_ACCEPTED
    assert wire.command(m.MAV_CMD_DO_PAUSE_CONTINUE, 1) == m.MAV_RESULT_ACCEPTED
    wire.run(25)
    assert wire.sim.p[:2] == pytest.approx((0.0, 20.0), abs=2.5)
    wire.send(m.MAVLink_mission_set_current_message(1, 1, 0))
    wire.run(1.1)
    assert wire.newest("MISSION_CURRENT").seq == 0


def test_a_second_link_waits_its_turn():
    wire = Planner(endpoint={"links": 2})
    wire.send(m.MAVLink_mission_count_message(1, 1, 1, MISSION), 1)
    ack = wire.ask(m.MAVLink_mission_count_message(1, 1, 1, MISSION), "MISSION_ACK")
    assert ack.type == m.MAV_MISSION_ERROR
    wire.send(waypoint(0, 3, 3), 1)
    assert len(wire.download()) == 1


@settings(max_examples=200)
@given(
    frame=st.integers(0, 12),
    command=st.sampled_from([16, 17, 19, 20, 21, 22, 31, 93, 177, 178, 5001, 5003, 5100, 9999]),
    params=st.tuples(*[st.floats(width=32)] * 4),
    x=st.integers(-(2**31), 2**31 - 1),
    y=st.integers(-(2**31), 2**31 - 1),
    z=st.floats(width=32),
)
def test_an_item_is_either_refused_or_finite(frame, command, params, x, y, z):
    item = Item(frame, command, 0, 1, params, x, y, z, integer=True)
    for read in (lambda: [leg(item)], lambda: legs([item]), lambda: zones([item] * 3)):
        try:
            found = read()
        except ItemError as error:
            assert 0 < error.result < m.MAV_MISSION_RESULT_ENUM_END
            continue
        for entry in found:
            assert "nan" not in repr(entry)
            assert "inf" not in repr(entry)
