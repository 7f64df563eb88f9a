"""What a recording holds of words and of the scene: paths of the entities that are neither numbers nor states."""

from __future__ import annotations

EVENTS = "/events"
COMMANDS = f"{EVENTS}/commands"
SCORE = f"{EVENTS}/score"
REASON = "/pilot/reason"
GUARDED = "/pilot/guarded_by"
UNSAFE = "/vehicle/unsafe"
FIRMWARE = "/vehicle/firmware"
PARAMETERS = "/vehicle/parameters"
INTERVENTIONS = "/interventions"
# Static text of the whole flight.
ABOUT = "/about"

WORLD = "/world"
GROUND = "/world/ground"
PAD = "/world/pad"
OBSTACLES = "/world/obstacles"
ROUTE = "/world/route"
TARGET = "/world/target"
VEHICLE_POSE = "/world/vehicle"
AIRFRAME = "/world/vehicle/airframe"
CHASED = "/world/vehicle/chased"
VEHICLE_TRAIL = "/world/vehicle_trail"
HAND_TRAIL = "/world/hand_trail"
HAND = "/world/hand"
PLUMB = "/world/plumb"
LEASH = "/world/leash"
FORCE_ARROW = "/world/force"
PREDICTED = "/world/predicted"
STOP = "/world/stop"
PROSPECT = "/world/prospect"
ECHOES = "/world/echoes"
INCIDENTS = "/world/incidents"
LOSSES = "/world/points_lost"
GHOST = "/world/ghost"
GHOST_TRAIL = "/world/ghost_trail"
# Length of the arrow that shows the force on the hand, m a newton.
ARROW_M_PER_N = 0.25

SCENE: tuple[tuple[str, str], ...] = (
    (f"{GROUND}, {PAD}", "the plane z = 0 and the place the vehicle starts from"),
    (
        f"{OBSTACLES}/NAME, {PAD}/NAME, {ROUTE}, {TARGET}",
        "the mission's obstacles (a gate's parts below its name), pads, route and target",
    ),
    (
        VEHICLE_POSE,
        "the vehicle's pose; `airframe` below it is a quadrotor 0.65 m wide, whatever it really is",
    ),
    (CHASED, "what the Chase view follows: corners without size, far enough apart to keep its distance"),
    (PLUMB, "a line from the vehicle down to z = 0"),
    (VEHICLE_TRAIL, "the way flown, in strips of five states"),
    (HAND_TRAIL, "the way of p_h while engaged, likewise"),
    (HAND, "p_h as a point, while engaged"),
    (LEASH, "p̃ as a line from p(t − d₁) to p_h, while engaged"),
    (
        FORCE_ARROW,
        f"the force on the hand as an arrow at the vehicle, {ARROW_M_PER_N} m a newton, while engaged",
    ),
    (PREDICTED, "where the vehicle will be when what is sent now reaches it, while engaged"),
    (STOP, "where it would come to rest from there with a centred handle, while engaged"),
    (PROSPECT, "a line from where it is seen through both, while engaged"),
    (ECHOES, "what the vehicle's own distance sensors see, as points"),
    (
        f"{GHOST}, {GHOST_TRAIL}",
        "where the flight that is followed was so long after take-off, and the way it came",
    ),
    (INCIDENTS, "collisions and alarms, as points where the vehicle was then"),
    (LOSSES, "the moments that cost points, where the vehicle was then, once it has landed"),
)
