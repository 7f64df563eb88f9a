"""The tables of the store, and how an older file becomes today's: each step leads from one version to the next."""

from __future__ import annotations

STEPS = (
    """
    CREATE TABLE pilots (id INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE COLLATE NOCASE);
    CREATE TABLE flights (
        id INTEGER PRIMARY KEY,
        pilot INTEGER NOT NULL REFERENCES pilots ON DELETE CASCADE,
        started TEXT NOT NULL,
        attempt INTEGER NOT NULL,
        mission TEXT NOT NULL,
        digest TEXT NOT NULL,
        seed INTEGER NOT NULL,
        simulated INTEGER NOT NULL,
        device TEXT NOT NULL,
        duration_s REAL NOT NULL,
        passed INTEGER,
        points REAL,
        parts TEXT NOT NULL,
        measures TEXT NOT NULL,
        recording TEXT NOT NULL,
        program TEXT NOT NULL,
        UNIQUE (pilot, started, attempt)
    );
    CREATE INDEX flights_by_mission ON flights (pilot, mission);
    CREATE TABLE tracks (
        flight INTEGER PRIMARY KEY REFERENCES flights ON DELETE CASCADE,
        track TEXT NOT NULL
    );
    CREATE TABLE workload (
        flight INTEGER PRIMARY KEY REFERENCES flights ON DELETE CASCADE,
        mental INTEGER NOT NULL, physical INTEGER NOT NULL, temporal INTEGER NOT NULL,
        performance INTEGER NOT NULL, effort INTEGER NOT NULL, frustration INTEGER NOT NULL
    );
    """,
    "ALTER TABLE flights ADD COLUMN instructed INTEGER NOT NULL DEFAULT 0;",
)
VERSION = len(STEPS)
