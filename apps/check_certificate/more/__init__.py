"""What no shipped proof uses: kinds of tasks, limits, rows, nodes and filters that are added to the tables of the core,
and functions that take the place of functions of the core. Imported once something is not known there, and for
settings."""
from more import contradictions, corner_feeds, differing_servos, families, instances, members, rows  # noqa: F401
from more import settings, splits, tasks, tree  # noqa: F401
