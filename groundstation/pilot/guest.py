"""A controller of the user's own, by `module:Class`: found, made, and watched.

Its code is not ours, so whatever it raises, and whatever it answers that is not a law, ends in a vehicle that holds
and no force on the hand, with words that name it.
"""

from __future__ import annotations

import importlib
import sys
from math import isfinite
from pathlib import Path
from typing import Any, cast

from groundstation.config import Settings
from groundstation.errors import InputError
from groundstation.pilot.controller import Controller, Law, PaperController, View

PAPER = "paper"


class ControllerError(Exception):
    """A controller did not do its part; the message says which and what, for the operator."""


class Guest:
    """Watches a controller.

    Args:
        name: For messages.
        controller: Whose code is not ours.
    """

    def __init__(self, name: str, controller: Controller) -> None:
        self._name = name
        self._controller = controller

    def start(self) -> object:
        """Return the controller's state at the moment of engaging.

        Raises:
            ControllerError: It raised something.
        """
        try:
            return self._controller.start()
        except Exception as error:
            raise self._fault(error) from error

    def step(self, state: Any, view: View, /) -> tuple[Any, Law]:  # noqa: ANN401
        """Return what the controller answers.

        Raises:
            ControllerError: It raised something, or answered no finite law.
        """
        try:
            state, law = self._controller.step(state, view)
            forward, left, up, turn = law.v_ref
            x, y, z = law.force
            sound = isfinite(forward + left + up + turn + x + y + z)
        except Exception as error:
            raise self._fault(error) from error
        if not sound:
            raise ControllerError(f"the controller {self._name} answered a number that is not finite")
        return state, law

    def _fault(self, error: Exception) -> ControllerError:
        return ControllerError(f"the controller {self._name} failed ({type(error).__name__}: {error})")


def load_controller(spec: str, settings: Settings) -> Controller:
    """Return the controller that `module:Class` names, made with the settings, or the paper's for "paper".

    A module is looked for beside the program's own and in the working folder.

    Raises:
        InputError: There is no such module or class, or it cannot be made.
    """
    if spec == PAPER:
        return PaperController()
    module, colon, name = spec.partition(":")
    if not (module and colon and name):
        raise InputError(f"controller {spec}: is neither 'paper' nor MODULE:CLASS; give one of the two.")
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.append(here)
    try:
        made = getattr(importlib.import_module(module), name, None)
        controller = None if made is None else made(settings)
    except ModuleNotFoundError as error:
        raise InputError(
            f"controller {spec}: no module {error.name!r}; run where it can be imported."
        ) from error
    except Exception as error:
        raise InputError(
            f"controller {spec}: cannot be made ({type(error).__name__}: {error}); it is called with the settings."
        ) from error
    if controller is None:
        raise InputError(f"controller {spec}: {module} has no {name}; check the class's name.")
    if not (callable(getattr(controller, "start", None)) and callable(getattr(controller, "step", None))):
        raise InputError(
            f"controller {spec}: has no start and step; see groundstation.pilot.controller.Controller."
        )
    return Guest(spec, cast("Controller", controller))
