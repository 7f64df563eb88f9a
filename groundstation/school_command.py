"""`groundstation school`: choose who flies and what, fly it, and come back to choose again."""

from __future__ import annotations

import argparse
import os

from groundstation.errors import InputError
from groundstation.fly import fly
from groundstation.login import login_name
from groundstation.progress.desk import Desk
from groundstation.terminal import has_screen


def run(asked: argparse.Namespace) -> int:
    """Do so until nothing more is chosen; return the exit code.

    Raises:
        InputError: There is no terminal, or what was asked for cannot be flown.
    """
    from groundstation.tui.hangup import watched
    from groundstation.tui.school import School

    if not has_screen(os.environ):
        raise InputError("the school needs a terminal; without one see 'groundstation progress'.")
    asked.sim = True
    asked.pilot = asked.pilot if asked.pilot is not None else login_name()
    code = 0
    while not code:
        with watched():
            wish = School(Desk(asked.logs), asked.pilot).run()
        if wish is None:
            break
        asked.mission, asked.pilot = wish
        code = fly(asked)
    return code
