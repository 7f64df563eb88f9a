"""How every pilot comes along: what they flew, what they can do, what comes next."""
