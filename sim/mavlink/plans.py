"""The mission protocol of MAVLink: plans go up and come down item by item. PX4's roles and times.

Two things are kinder than PX4: a download needs no state here, so a request is answered whenever it comes; and an
upload that is begun again begins again, where PX4 refuses it until the old one has timed out.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from pymavlink.dialects.v20 import common as m

from sim.autopilot.notices import Severity
from sim.mavlink.dialect import Address, mission_ack, mission_count
from sim.mavlink.items import Item, ItemError, item_from
from sim.mavlink.plan_store import MOST_ITEMS, PlanStore
from sim.mavlink.shared import Shared
from sim.mavlink.wire import Outbox

RETRY_S, TIMEOUT_S = 0.25, 5.0
ItemMessage = m.MAVLink_mission_item_int_message | m.MAVLink_mission_item_message
ItemRequest = m.MAVLink_mission_request_int_message | m.MAVLink_mission_request_message


@dataclass
class Upload:
    """A plan on its way up.

    Attributes:
        partner: Who sends it.
        kind: MAV_MISSION_TYPE.
        count: How many items it will have.
        items: Those that have come.
        integer: Items are asked for as MISSION_ITEM_INT.
        asked_t: When the last was asked for, s.
        heard_t: When the partner was heard last, s.
    """

    partner: Address
    kind: int
    count: int
    heard_t: float
    items: list[Item] = field(default_factory=list[Item])
    integer: bool = True
    asked_t: float = 0.0


class PlanService:
    """MISSION_* on one link.

    Args:
        shared: The vehicle.
        number: The link's.
        outbox: Where answers go.
    """

    def __init__(self, shared: Shared, number: int, outbox: Outbox) -> None:
        self._sim = shared.simulator
        self._store: PlanStore = shared.plans
        self._number = number
        self._outbox = outbox
        self._upload: Upload | None = None
        self._done: Upload | None = None

    def step(self) -> None:
        """Ask again for an item of an upload that did not come; give up after a while."""
        upload, t = self._upload, self._sim.t
        if upload is None:
            return
        if t - upload.heard_t > TIMEOUT_S:
            self._sim.autopilot.say(Severity.CRITICAL, "Plan upload timed out; the old plan stays")
            self._end()
        elif t - upload.asked_t > RETRY_S:
            # Who does not answer one form of the question may know the other.
            upload.integer = not upload.integer
            self._ask(upload)

    def list(self, message: m.MAVLink_mission_request_list_message) -> None:
        """Say how many items there are."""
        stored = self._store[message.mission_type]
        count = mission_count(_sender(message), len(stored.items), message.mission_type, stored.opaque_id)
        self._outbox.send(count)

    def request(self, message: ItemRequest) -> None:
        """Give an item, in the form it is asked for."""
        items = self._store[message.mission_type].items
        if message.seq >= len(items):
            self._acknowledge(_sender(message), m.MAV_MISSION_INVALID_SEQUENCE, message.mission_type)
            return
        integer = message.get_msgId() == m.MAVLINK_MSG_ID_MISSION_REQUEST_INT
        make = _item_int if integer else _item
        current = message.mission_type == 0 and message.seq == self._sim.autopilot.mission_index
        answer = make(items[message.seq], _sender(message), message.seq, message.mission_type, current)
        self._outbox.send(answer)

    def count(self, message: m.MAVLink_mission_count_message) -> None:
        """Begin an upload."""
        partner, kind = _sender(message), message.mission_type
        busy = self._store.uploading not in (None, self._number)
        if busy or (self._upload is not None and self._upload.partner != partner):
            self._acknowledge(partner, m.MAV_MISSION_ERROR, kind)
        elif kind not in MOST_ITEMS:
            self._acknowledge(partner, m.MAV_MISSION_UNSUPPORTED, kind)
        elif message.count > MOST_ITEMS[kind]:
            self._acknowledge(partner, m.MAV_MISSION_NO_SPACE, kind)
        else:
            self._upload = Upload(partner, kind, message.count, self._sim.t)
            self._store.uploading = self._number
            self._go_on(self._upload)

    def item(self, message: ItemMessage) -> None:
        """Take the item that was asked for."""
        upload, partner = self._upload, _sender(message)
        if upload is None:
            self._late_item(message)
        elif partner != upload.partner or message.seq != len(upload.items):
            return
        elif message.mission_type != upload.kind:
            self._acknowledge(partner, m.MAV_MISSION_ERROR, message.mission_type)
        else:
            upload.heard_t = self._sim.t
            upload.items.append(item_from(message))
            self._go_on(upload)

    def acknowledged(self, message: m.MAVLink_mission_ack_message) -> None:
        """Hear how the other side takes it: it may know only one form of the question, or have had enough."""
        upload = self._upload
        if upload is None or _sender(message) != upload.partner:
            return
        if message.type == m.MAV_MISSION_UNSUPPORTED:
            upload.integer = not upload.integer
            self._ask(upload)
        elif message.type == m.MAV_MISSION_OPERATION_CANCELLED:
            self._end()

    def clear(self, message: m.MAVLink_mission_clear_all_message) -> None:
        """Forget a plan, or all."""
        kind = message.mission_type
        kinds = tuple(MOST_ITEMS) if kind == m.MAV_MISSION_TYPE_ALL else (kind,)
        if self._store.uploading is not None:
            self._acknowledge(_sender(message), m.MAV_MISSION_ERROR, kind)
        elif not set(kinds) <= set(MOST_ITEMS):
            self._acknowledge(_sender(message), m.MAV_MISSION_UNSUPPORTED, kind)
        else:
            results = {self._load(each, []) for each in kinds}
            self._acknowledge(_sender(message), max(results), kind)

    def set_current(self, message: m.MAVLink_mission_set_current_message) -> None:
        """Go on with another item."""
        self._sim.autopilot.set_mission_index(message.seq)

    def _late_item(self, message: ItemMessage) -> None:
        """Answer an item that nobody asked for: again, where it is the last of an upload that has ended."""
        done, partner = self._done, _sender(message)
        if done is not None and done.partner == partner and message.seq == done.count - 1:
            opaque_id = self._store[done.kind].opaque_id
            self._acknowledge(partner, m.MAV_MISSION_ACCEPTED, done.kind, opaque_id)
        else:
            self._acknowledge(partner, m.MAV_MISSION_ERROR, message.mission_type)

    def _go_on(self, upload: Upload) -> None:
        if len(upload.items) < upload.count:
            self._ask(upload)
            return
        result = self._load(upload.kind, upload.items)
        self._end()
        self._done = upload if result == m.MAV_MISSION_ACCEPTED else None
        opaque_id = self._store[upload.kind].opaque_id
        self._acknowledge(upload.partner, result, upload.kind, opaque_id)

    def _load(self, kind: int, items: list[Item]) -> int:
        try:
            self._store.load(kind, items)
        except ItemError as error:
            self._sim.autopilot.say(Severity.CRITICAL, f"Plan refused: {error}")
            return error.result
        return m.MAV_MISSION_ACCEPTED

    def _ask(self, upload: Upload) -> None:
        upload.asked_t = self._sim.t
        kinds = (m.MAVLink_mission_request_message, m.MAVLink_mission_request_int_message)
        self._outbox.send(kinds[upload.integer](*upload.partner, len(upload.items), upload.kind))

    def _end(self) -> None:
        self._upload = self._store.uploading = None

    def _acknowledge(self, to: Address, result: int, kind: int, opaque_id: int = 0) -> None:
        self._outbox.send(mission_ack(to, result, kind, opaque_id))


def _sender(message: m.MAVLink_message) -> Address:
    return message.get_srcSystem(), message.get_srcComponent()


def _item_int(item: Item, to: Address, seq: int, kind: int, current: bool) -> m.MAVLink_message:
    scale = 1.0 if item.integer or item.frame == m.MAV_FRAME_MISSION else 1e7
    x, y = (_whole(value * scale) for value in (item.x, item.y))
    head = (item.frame, item.command, int(current), item.autocontinue)
    return m.MAVLink_mission_item_int_message(*to, seq, *head, *item.params, x, y, item.z, kind)


def _item(item: Item, to: Address, seq: int, kind: int, current: bool) -> m.MAVLink_message:
    scale = 1e-7 if item.integer and item.frame != m.MAV_FRAME_MISSION else 1.0
    head = (item.frame, item.command, int(current), item.autocontinue)
    place = (item.x * scale, item.y * scale, item.z)
    return m.MAVLink_mission_item_message(*to, seq, *head, *item.params, *place, kind)


def _whole(value: float) -> int:
    """Return a number as the wire's 32 bits hold it; what is none is unset."""
    return round(value) if -0x80000000 <= value < 0x7FFFFFFF else 0x7FFFFFFF
