"""`python -m sim`: see `sim.process.cli`."""

import sys

from sim.process.cli import main

if __name__ == "__main__":
    sys.exit(main())
