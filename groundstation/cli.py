"""The command line: what the user asked for, checked, then handed to the part that does it.

Nothing heavy is imported before it is needed: `--help` must answer at once.
"""

from __future__ import annotations

import argparse
import errno
import importlib
import os
import sys
from collections.abc import Callable, Sequence
from types import ModuleType
from typing import NoReturn, cast

from groundstation import __version__, fly_options
from groundstation import excite_options as excite
from groundstation import preflight_options as preflight
from groundstation import school_options as school
from groundstation.devices import options as devices
from groundstation.errors import InputError
from groundstation.evaluation import options as evaluate
from groundstation.export import options as export
from groundstation.identification import options as identify
from groundstation.instruct import options as instruct
from groundstation.progress import options as progress
from groundstation.replay import options as replay
from groundstation.report import options as report
from groundstation.review import options as review
from groundstation.shown import shown
from groundstation.terminal import has_screen
from groundstation.training import options as missions

PROGRAM = "groundstation"
EXIT_FAILED, EXIT_BAD_INPUT = 1, 2
_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EROFS)
# The commands besides flying. Each is a module with its HELP, DESCRIPTION and EXAMPLES, `fill`, which adds its
# options to a parser, and RUN, the function that does it, as "module:function".
_COMMANDS: dict[str, ModuleType] = {
    "school": school,
    "preflight": preflight,
    "review": review,
    "report": report,
    "replay": replay,
    "export": export,
    "identify": identify,
    "excite": excite,
    "evaluate": evaluate,
    "missions": missions,
    "instruct": instruct,
    "progress": progress,
    "devices": devices,
}

_EXAMPLES = """\
examples:
  groundstation                                              choose vehicle, device and mission, then fly
  groundstation school                                       learn to fly, step by step
  groundstation --sim                                        fly the simulated vehicle
  groundstation --sim --mission paper                        fly a mission by hand
  groundstation --sim --headless --mission paper --json      let the scripted hand fly it
  groundstation --connect udpin://0.0.0.0:14540              fly a real PX4 vehicle
  groundstation --connect serial:///dev/ttyUSB0:57600        the same through a radio
  groundstation preflight --connect udpin://0.0.0.0:14540    every check before a flight, with an exit code
  groundstation review                                       look at the last flight
  groundstation report                                       a page on the last flight, to mail
  groundstation replay                                       the last flight's hand through today's pilot
  groundstation export --to mcap                             the last flight for Foxglove
  groundstation excite --sim                                 fly what identification needs
  groundstation identify FLIGHT.rrd                          the vehicle's dynamic model out of a flight
  groundstation evaluate --delay 0,0.1,0.3                   compare controllers over hundreds of virtual flights
  groundstation missions list                                what there is to fly
  groundstation instruct                                     wind, delay and failures while a trainee flies
  groundstation progress                                     how you come along, and what to fly next
  groundstation devices                                      which haptic devices are there

exit codes: 0 done, or the mission's criteria hold; 1 they do not, or a process died; 2 bad input
"""


class _Parser(argparse.ArgumentParser):
    """Says what is wrong in one line, without the whole usage."""

    def error(self, message: str) -> NoReturn:
        """End with exit code 2."""
        self.exit(EXIT_BAD_INPUT, f"{self.prog}: {message} (try --help)\n")


def build_parser() -> argparse.ArgumentParser:
    """Return the parser of the whole command line."""
    parser = _Parser(
        prog=PROGRAM,
        description="Ground station for bilateral haptic teleoperation of multirotors: feel the drone.",
        epilog=_EXAMPLES,
        formatter_class=_RAW,
    )
    parser.add_argument("--version", action="version", version=f"{PROGRAM} {__version__}")
    fly_options.fill(parser)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", title="commands besides flying")
    for name, options in _COMMANDS.items():
        command = commands.add_parser(
            name,
            help=options.HELP,
            description=options.DESCRIPTION,
            epilog=options.EXAMPLES,
            formatter_class=_RAW,
        )
        options.fill(command)
    completion = commands.add_parser(
        "completion",
        help="print a shell's completion script",
        description=_COMPLETION,
        epilog=_COMPLETION_EXAMPLES,
        formatter_class=_RAW,
    )
    completion.add_argument(
        "shell", metavar="SHELL", choices=("bash", "zsh", "tcsh"), help="bash, zsh or tcsh"
    )
    return parser


_RAW = argparse.RawDescriptionHelpFormatter
_COMPLETION = """\
Print a shell's completion script: commands, options, and what they take, such as missions, airframes, devices
and recordings. It holds their names, and starts no Python: print it again after an update."""
_COMPLETION_EXAMPLES = """\
examples:
  eval "$(groundstation completion bash)"                    in this shell only; zsh likewise
  groundstation completion bash > ~/.local/share/bash-completion/completions/groundstation
  groundstation completion zsh > ~/.zfunc/_groundstation     with ~/.zfunc in fpath
"""


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit with its code."""
    parser = build_parser()
    asked = parser.parse_args(arguments)
    try:
        code = _dispatch(parser, asked)
        # What is still to be written is written here, where somebody can say that there is no room for it.
        sys.stdout.flush()
    except InputError as error:
        print(shown(f"{PROGRAM}: {error}"), file=sys.stderr)
        code = EXIT_BAD_INPUT
    except KeyboardInterrupt:
        code = 130
    except BrokenPipeError:
        # Whoever read our output has gone (`| head`); that is no error of ours.
        sys.stderr.close()
        code = 0
    except OSError as error:
        if error.errno not in _NO_ROOM:
            raise
        print(f"{PROGRAM}: {_full(error)}", file=sys.stderr)
        code = EXIT_FAILED
    sys.exit(code)


def _full(error: OSError) -> str:
    if error.filename:
        return f"{error.filename}: cannot be written ({error.strerror}); free the disk, or write elsewhere."
    # What Python still holds for it would fail once more at exit.
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    return f"what was asked for cannot be written ({error.strerror}); free the disk, or let the output go elsewhere."


def _dispatch(parser: argparse.ArgumentParser, asked: argparse.Namespace) -> int:
    if asked.command == "completion":
        from groundstation import completion

        print(completion.script(parser, asked.shell))
        return 0
    if asked.command:
        module, _, function = _COMMANDS[asked.command].RUN.partition(":")
        run = cast(Callable[[argparse.Namespace], int], getattr(importlib.import_module(module), function))
        return run(asked)
    if not asked.sim and not asked.connect:
        if asked.headless or asked.plain or not has_screen(os.environ):
            parser.print_help()
            return EXIT_BAD_INPUT
        from groundstation import connecting

        if not connecting.connect(asked):
            return 0
    from groundstation import fly

    return fly.fly(asked)


if __name__ == "__main__":
    main()
