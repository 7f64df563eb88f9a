"""No net energy for the hand: the account of the haptic port, and what may keep it; bounds of a sampled spring."""
