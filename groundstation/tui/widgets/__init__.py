"""The instruments on the screens, one file each."""
