"""The settings that the docs show are the settings there are, with their defaults."""

import re
import tomllib
from pathlib import Path

import msgspec

from groundstation.config import Settings

DOC = Path(__file__).resolve().parents[1] / "docs" / "control.md"


def test_the_docs_show_every_setting_with_its_default() -> None:
    shown = tomllib.loads(re.search(r"```toml\n(.*?)```", DOC.read_text(encoding="utf-8"), re.DOTALL)[1])
    assert msgspec.convert(shown, Settings) == Settings()
    known = {
        name: {key.encode_name for key in msgspec.structs.fields(field.type)}
        for name, field in ((f.encode_name, f) for f in msgspec.structs.fields(Settings))
        if name != "devices"
    }
    assert {name: set(table) for name, table in shown.items()} == known
