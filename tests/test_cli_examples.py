"""What the help shows can be typed as it stands: every example of every command is read by the real parser."""

import argparse
import re
import shlex

import pytest

from groundstation import cli

HELPS = {name: options.EXAMPLES for name, options in cli._COMMANDS.items()} | {
    "": cli._EXAMPLES,
    "completion": cli._COMPLETION_EXAMPLES,
}


def examples():
    for name, text in HELPS.items():
        for line in text.splitlines():
            if line.startswith("  groundstation"):
                # What it does stands behind it, two spaces away; where the output goes is the shell's.
                typed = re.split(r" {2,}| > ", line.strip())[0]
                yield pytest.param(name, typed, id=typed)


@pytest.mark.parametrize(("name", "typed"), list(examples()))
def test_an_example_can_be_typed_as_it_stands(name, typed):
    program, *arguments = shlex.split(typed)
    asked = cli.build_parser().parse_args(arguments)
    assert program == "groundstation"
    # Some help ends with what one does next.
    assert asked.command in {name or asked.command, None}


@pytest.mark.parametrize("name", HELPS)
def test_every_help_has_examples_and_says_its_exit_codes(name):
    assert HELPS[name].startswith("examples:\n")
    if name not in {"completion", "devices"}:
        assert "exit codes:" in HELPS[name].lower()


def parsers(parser, path="groundstation"):
    yield path, parser
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, each in action.choices.items():
                yield from parsers(each, f"{path} {name}")


@pytest.mark.parametrize(("path", "parser"), list(parsers(cli.build_parser())))
def test_everything_that_can_be_typed_is_explained(path, parser):
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            silent = set(action.choices) - {each.dest for each in action._choices_actions}
            assert not silent, f"{path}: {silent}"
            assert all(each.help for each in action._choices_actions)
        else:
            assert action.help, f"{path} {action.option_strings or action.dest}"


def test_every_command_stands_in_the_examples_of_the_whole():
    missing = [name for name in cli._COMMANDS if f"groundstation {name}" not in cli._EXAMPLES]
    assert not missing


@pytest.mark.parametrize(("path", "parser"), list(parsers(cli.build_parser())))
def test_the_own_lines_of_a_help_fit_a_wide_terminal(path, parser):
    for text in (parser.description, parser.epilog):
        assert all(len(line) <= 118 for line in (text or "").splitlines()), path
