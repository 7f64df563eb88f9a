"""A shell's completion script: the command line's words, and the values that its options take.

The names are written into the script, so that a shell completes without starting Python; a new version of the
program prints a new script.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import shtab

from drivers.emulators.registry import BUILT_IN as EMULATORS
from drivers.registry import driver_names
from groundstation.training.mission import MISSIONS_FOLDER
from sim.airframe import PRESETS_FOLDER

_CONTROLLERS = ("paper", "assisted", "transparent", "training")
# What options take that are named by what they are. "FLIGHT" and "DIR" are told by their placeholder.
_KINDS = {
    "mission": "missions",
    "missions": "missions",
    "airframe": "airframes",
    "like": "airframes",
    "compare": "airframes",
    "device": "devices",
    "source": "recordings",
    "validate": "recordings",
    "config": "tables",
}
_OF_PLACEHOLDER = {
    "FLIGHT": "recordings",
    "FLIGHT.rrd": "recordings",
    "FLIGHT...": "recordings",
    "FILE": "files",
    "PATH": "files",
    "DIR": "folders",
}
# By command and name, where the name alone says too little.
_OF_COMMAND = {
    ("missions check", "files"): "tables",
    ("evaluate", "controller"): "controllers",
    ("evaluate", "guard"): "guards",
    ("evaluate", "operator"): "operators",
    ("devices emulate", "name"): "emulators",
}
# Bash parts words at colons and equals signs, so that an address or `--option=value` would be three; and it puts what
# is completed behind the last of them.
_WHOLE_WORDS = r"""
_groundstation_whole_words() {
  local line="${COMP_LINE:0:COMP_POINT}" before option
  local -a COMP_WORDS
  read -a COMP_WORDS <<<"$line"
  [[ "$line" == *[[:space:]] ]] && COMP_WORDS+=("")
  local last=$((${#COMP_WORDS[@]} - 1))
  local word="${COMP_WORDS[last]}"
  before="${word%"${word##*[:=]}"}"
  if [[ "$word" == --*=* ]]; then
    option="${word%%=*}"
    COMP_WORDS[last]="$option"
    COMP_WORDS+=("${word#*=}")
    before="${before#"$option="}"
    last=$((last + 1))
  fi
  local COMP_CWORD=$last
  _shtab_groundstation
  local index
  for index in "${!COMPREPLY[@]}"; do COMPREPLY[index]="${COMPREPLY[index]#"$before"}"; done
}
complete -o bashdefault -F _groundstation_whole_words groundstation
"""


class _Kind(NamedTuple):
    """What a value may be: names, files by their ending, or both.

    Attributes:
        names: The names.
        ending: Of files, with its dot; "" for none.
        folder: Where such files are looked for besides, as from the folder one is in; "" for nowhere.
    """

    names: Sequence[str] = ()
    ending: str = ""
    folder: str = ""


def script(parser: argparse.ArgumentParser, shell: str) -> str:
    """Return a shell's completion script.

    Args:
        parser: Of the whole command line; its actions are told what they complete.
        shell: "bash", "zsh" or "tcsh".
    """
    completers = {name: _completer(name, kind) for name, kind in _kinds().items()}
    completers |= {"files": shtab.FILE, "folders": shtab.DIRECTORY}
    for command, action in _values(parser, ""):
        if kind := _kind_of(command, action):
            setattr(action, "complete", completers[kind])  # noqa: B010 - shtab's own attribute, unknown to argparse
        if shell == "zsh" and isinstance(action.metavar, str):
            # Where zsh is told of a value, a colon ends its name.
            action.metavar = action.metavar.replace(":", r"\:")
    return shtab.complete(parser, shell=shell) + (_WHOLE_WORDS if shell == "bash" else "")


def _kinds() -> dict[str, _Kind]:
    """Return what there is to be completed, by name."""
    missions = sorted(path.stem for path in MISSIONS_FOLDER.glob("*.toml"))
    airframes = sorted(path.stem for path in PRESETS_FOLDER.glob("*.toml"))
    return {
        "missions": _Kind(missions, ".toml"),
        "airframes": _Kind(airframes, ".toml"),
        "devices": _Kind((*driver_names(), *(f"emulated:{name}" for name in EMULATORS))),
        "recordings": _Kind((), ".rrd", "logs"),
        "tables": _Kind((), ".toml"),
        "controllers": _Kind(_CONTROLLERS),
        "guards": _Kind(("barrier", "risk_field", "off")),
        "operators": _Kind(("novice", "average", "expert")),
        "emulators": _Kind(tuple(EMULATORS)),
    }


def _values(parser: argparse.ArgumentParser, command: str) -> Iterator[tuple[str, argparse.Action]]:
    """Yield all that takes a value, with the command it belongs to."""
    for action in parser._actions:  # noqa: SLF001 - argparse has no other way to them
        if isinstance(action.choices, dict):
            for name, parts in action.choices.items():
                yield from _values(parts, f"{command} {name}".strip())
        elif action.nargs != 0 and not action.choices:
            yield command, action


def _kind_of(command: str, action: argparse.Action) -> str:
    """Return the kind of an action's values; "" where they are anybody's guess."""
    by_placeholder = _OF_PLACEHOLDER.get(str(action.metavar), "")
    return _OF_COMMAND.get((command, action.dest)) or _KINDS.get(action.dest) or by_placeholder


def _completer(name: str, kind: _Kind) -> dict[str, str | dict[str, str]]:
    """Return how each shell completes a kind. "file" in a function's name has bash treat what it returns as paths."""
    function = f"_groundstation_{'file_' if kind.ending else ''}{name}"
    words = " ".join(kind.names)
    tcsh = f"({words})" if kind.names else f"f:*{kind.ending}"
    return {
        "bash": function,
        "zsh": function,
        "tcsh": tcsh,
        "preamble": {"bash": _bash(function, words, kind), "zsh": _zsh(function, name, words, kind)},
    }


def _bash(function: str, words: str, kind: _Kind) -> str:
    lines = [f'  compgen -W "{words}" -- "$1"'] if words else []
    if kind.ending:
        # Where there are names, paths come only once something was typed: folders would hide them.
        lines += ['  [[ -n "$1" ]] || return 0'] if words else []
        lines += [f"""  compgen -f -X '!*{kind.ending}' -- "$1\"""", '  compgen -d -- "$1"']
    if kind.folder:
        lines.append(f"""  [[ "$1" == */* ]] || compgen -f -X '!*{kind.ending}' -- "{kind.folder}/$1\"""")
    return "\n".join((f"{function}() {{", *lines, "}"))


def _zsh(function: str, name: str, words: str, kind: _Kind) -> str:
    lines = [f"  compadd -X '{name}' -- {words}"] if words else []
    if kind.ending:
        lines.append(f"  _files -g '*{kind.ending}'")
    if kind.folder:
        lines.append(f"  compadd -f -U -- {kind.folder}/$PREFIX*{kind.ending}(N)")
    return "\n".join((f"{function}() {{", *lines, "}"))
