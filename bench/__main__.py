"""Measure and print tables: `python -m bench [NAME ...] [--short]`.

Absolute times depend on the machine; what is compared is compared within one run.
"""

from __future__ import annotations

import argparse
import importlib
import os
import platform

BENCHES = {
    "help": "processor time of --help",
    "start": "from the command to a vehicle that may take off",
    "step_to_wire": "from a step of the handle to the datagram that carries it",
    "key_to_wire": "from an urgent key on any screen to the command on its way to the vehicle",
    "models": "steps per second of the rigid body, beside other simulators",
    "paper": "the paper's mission, headless",
    "vehicle": "start, memory and share of a core of the simulated vehicle",
    "fuzz": "a million hostile datagrams at the vehicle",
    "fuzz_station": "a million hostile inputs at pilot and gate",
    "fuzz_link": "a million hostile datagrams from the vehicle at the link",
    "falcon": "the Falcon's driver: exactness, spoilt bytes, cost of a tick",
    "servo": "pace of the servo on an emulated device, against a bare C loop",
    "passivity": "energy at the haptic port with delay and loss",
    "screen": "what the screen costs while it flies, and what its freezing changes in flight",
    "pilot_step": "cost and memory of a tick of the pilot with everything on",
    "stability": "how well the drone follows, and whether anything swings at 0.7 s round trip",
    "evaluate": "how many times as fast as real time flights are evaluated",
    "recording": "what recording costs: share of a core, MB a minute, rows lost",
    "killed": "what a recording misses after a process of the flight was killed",
    "soak": "the whole program for half an hour with random faults: what dies, grows, falls behind",
    "reconnect": "a thousand times connected and cut off: what memory and descriptors the link keeps",
    "report": "report on a flight of ten minutes, and loading it",
    "identify": "how exactly χ comes back out of noisy flights of every preset",
    "school": "every mission flown by simulated operators: who passes, and in which order",
    "shield": "full-stick adversaries through obstacle fields, with and without the guard",
}


def main() -> None:
    """Run the benches asked for."""
    listed = "\n".join(f"  {name:<14} {what}" for name, what in BENCHES.items())
    parser = argparse.ArgumentParser(
        prog="python -m bench",
        description=__doc__,
        epilog=f"benches:\n{listed}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("names", nargs="*", choices=[*BENCHES, []], metavar="NAME", help="default: all")
    parser.add_argument("--short", action="store_true", help="few repetitions, for a look or for CI")
    asked = parser.parse_args()
    print(f"Python {platform.python_version()}, {os.cpu_count()} cores")
    for name in asked.names or BENCHES:
        print(f"\n{name}: {BENCHES[name]}")
        for line in importlib.import_module(f"bench.{name}").main(short=asked.short):
            print(f"  {line}", flush=True)


if __name__ == "__main__":
    main()
