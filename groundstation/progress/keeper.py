"""Keeps each flight of a mission once it has landed: the one place where live flights become progress.

It writes in a thread of its own, for a slow disk must not hold up a screen that somebody flies by. What goes wrong
is said in words; the flight goes on, and its recording holds all that is needed to make up for it.
"""

from __future__ import annotations

import queue
import threading

from groundstation.errors import InputError
from groundstation.progress.flown import Flown
from groundstation.progress.judging import flight_of, judged
from groundstation.progress.opening import store_in
from groundstation.progress.store import Store
from groundstation.run import Run
from groundstation.training.attempts import Attempts
from groundstation.training.measures import Track
from groundstation.training.workload import Workload


class Keeper:
    """Keeps the flights of a run. Those of nobody, such as the scripted hand's, are nobody's progress.

    Args:
        run: The run.
        attempts: Its flights, as they are measured.

    Attributes:
        kept: Number in the store of the last flight that landed; 0 before it is written.
    """

    def __init__(self, run: Run, attempts: Attempts) -> None:
        self._run, self._attempts = run, attempts
        self._path = store_in(run.recording.parent)
        self._known = flight_of(run)
        self._seen = 0
        self._words: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._threads: list[threading.Thread] = []
        self.kept = self._told = 0

    def look(self) -> list[str]:
        """Keep what has landed since; return what there is to be said of it."""
        for measurer in self._attempts.take():
            self._seen += 1
            if self._run.pilot:
                flown = judged(self._known, self._seen, measurer, self._run.par)
                self._start(flown, measurer.track())
        words: list[str] = []
        while not self._words.empty():
            words.append(self._words.get())
        return words

    def fresh(self) -> bool:
        """Say once of each flight that it is in the store."""
        new = self.kept not in (0, self._told)
        self._told = self.kept
        return new

    def keep_workload(self, workload: Workload) -> None:
        """Keep how hard the last flight that landed felt."""
        for thread in self._threads:
            thread.join()
        if self.kept:
            try:
                with Store(self._path) as store:
                    store.set_workload(self.kept, workload)
            except InputError as error:
                self._words.put(str(error))

    def close(self) -> list[str]:
        """Wait until all is written; return what is left to be said."""
        words = self.look()
        for thread in self._threads:
            thread.join()
        return [*words, *self.look()]

    def _start(self, flown: Flown, track: Track) -> None:
        self.kept = self._told = 0
        thread = threading.Thread(target=self._keep, args=(flown, track), name="progress")
        self._threads = [*(each for each in self._threads if each.is_alive()), thread]
        thread.start()

    def _keep(self, flown: Flown, track: Track) -> None:
        try:
            with Store(self._path) as store:
                if store.words:
                    self._words.put(store.words)
                self.kept = store.add(flown, track)
        except InputError as error:
            self._words.put(f"{error} The recording has the flight: 'groundstation progress import' adds it.")
