"""The settings as a flat list, and one of them changed: by the settings' own rules, in the file by its line.

Only the line of the key that changes is written, so that what people noted beside it in the file stays.
"""

from __future__ import annotations

import functools
import inspect
import re
import tempfile
import tomllib
from pathlib import Path
from typing import Any, NamedTuple, cast

import msgspec
import tomli_w

from groundstation.config import Settings, load_settings
from groundstation.errors import InputError
from sim.scenario import error_sentence

# What the pilot takes while it runs; the rest is read once by each process.
LIVE = frozenset({"mapping", "buttons", "control", "cues", "shield", "limits", "link"})


class Entry(NamedTuple):
    """One setting.

    Attributes:
        section, key: As in the file.
        value: As TOML writes it.
        usual: It is the default.
        explains: What it is, as the settings' own description says.
    """

    section: str
    key: str
    value: str
    usual: bool
    explains: str = ""

    @property
    def live(self) -> bool:
        """It takes effect in the running flight."""
        return self.section in LIVE


def entries(settings: Settings) -> list[Entry]:
    """Return all settings of the program; those of device drivers are the drivers' own."""
    now, usual = _tables(settings), _tables(Settings())
    return [
        Entry(section, key, _toml(value), value == usual[section][key], words.get(key, ""))
        for section, table in now.items()
        if section != "devices"
        for words in [_explanations(type(getattr(settings, section)))]
        for key, value in table.items()
    ]


def changed(settings: Settings, section: str, key: str, text: str) -> Settings:
    """Return the settings with one changed, as it is written in the file.

    Raises:
        InputError: It is not TOML, or the settings do not allow it; with the reason.
    """
    tables = _tables(settings)
    tables[section][key] = _value(text)
    try:
        return msgspec.convert(tables, Settings, strict=True)
    except msgspec.ValidationError as error:
        raise InputError(error_sentence(error)) from error


def save(path: Path, section: str, key: str, text: str) -> None:
    """Write one setting into a file, and leave all else in it as it is.

    Raises:
        InputError: The file cannot be written, or what came out would not be read as meant.
    """
    try:
        before = path.read_text(encoding="utf-8") if path.exists() else ""
        path.parent.mkdir(parents=True, exist_ok=True)
        after = with_line(before, section, key, text)
        with tempfile.NamedTemporaryFile(
            "w", dir=path.parent, prefix=path.name, suffix=".new", delete=False, encoding="utf-8"
        ) as file:
            file.write(after)
        new = Path(file.name)
        try:
            load_settings(new)
            read = tomllib.loads(after)[section][key]
            if read != _value(text):
                raise InputError(f"{path}: {section}.{key} stands there in another way; change it by hand.")
            new.replace(path)
        finally:
            new.unlink(missing_ok=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror}); nothing was saved.") from error


def with_line(before: str, section: str, key: str, text: str) -> str:
    """Return a file's text with a key's line replaced, or added to its section, or the section added."""
    lines = before.splitlines()
    start = next((i for i, line in enumerate(lines) if re.match(rf"\s*\[\s*{section}\s*\]", line)), None)
    written = f"{key} = {text}"
    if start is None:
        return "\n".join([*lines, *([""] if lines else []), f"[{section}]", written, ""])
    end = next((i for i in range(start + 1, len(lines)) if re.match(r"\s*\[", lines[i])), len(lines))
    for i in range(start + 1, end):
        if re.match(rf"\s*{key}\s*=", lines[i]):
            lines[i] = written + _comment(lines[i])
            break
    else:
        lines.insert(start + 1, written)
    return "\n".join([*lines, ""])


@functools.cache
def _explanations(table: type) -> dict[str, str]:
    """Return what each field of a table is, out of its description: `name, other: words` with lines that go on."""
    described = inspect.cleandoc(table.__doc__ or "").partition("Attributes:\n")[2]
    found: dict[str, str] = {}
    names: list[str] = []
    for line in described.splitlines():
        if begun := re.match(r" {4}([a-z]\w*(?:, \w+)*): (.*)", line):
            names = begun[1].split(", ")
            found |= dict.fromkeys(names, begun[2])
        elif line.strip():
            found |= {name: f"{found[name]} {line.strip()}" for name in names}
    return {name: re.sub(r"[`*]", "", words) for name, words in found.items()}


def _comment(line: str) -> str:
    """Return what was noted at the end of a line, where no text value could hold the sign."""
    found = re.search(r"\s+#.*$", line)
    return found[0] if found and '"' not in found[0] and "'" not in found[0] else ""


def _tables(settings: Settings) -> dict[str, dict[str, Any]]:
    # Through JSON, so that tuples become the lists that a file has.
    return cast("dict[str, dict[str, Any]]", msgspec.json.decode(msgspec.json.encode(settings)))


def _toml(value: object) -> str:
    """Write a value as in the file, on one line."""
    if isinstance(value, list):
        return f"[{', '.join(_toml(each) for each in cast('list[object]', value))}]"
    return tomli_w.dumps({"x": value}).strip().partition(" = ")[2]


def _value(text: str) -> object:
    try:
        tables = tomllib.loads(f"x = {text}")
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"{text}: is not a value as TOML has them; a word stands in quotes.") from error
    if set(tables) != {"x"}:
        raise InputError(f"{text}: is more than one value.")
    return tables["x"]
