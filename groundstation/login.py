"""Who is logged in on this machine: the pilot where nobody is named."""

from __future__ import annotations

import getpass


def login_name() -> str:
    """Return the name, or "" where the system does not know."""
    try:
        return getpass.getuser()
    except (KeyError, OSError):
        return ""
