"""What all tests share."""

from hypothesis import settings

# Examples run on machines shared with other work: how long one takes says nothing.
settings.register_profile("groundstation", deadline=None)
settings.load_profile("groundstation")
