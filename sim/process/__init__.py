"""The simulated vehicle as a process: command line, loop, links, status line."""
