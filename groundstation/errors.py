"""The one kind of error that is the user's to mend."""


class InputError(Exception):
    """What the user gave is wrong: the message is one sentence with what, where and what to do. Exit code 2."""
