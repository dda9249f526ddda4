"""What one mutation is: a bug, planted by replacing a text that occurs once in a file."""

from typing import NamedTuple


class Mutation(NamedTuple):
    name: str  # for the command line and the table of results
    file: str  # below the root of the sources
    old: str  # occurs exactly once in the file
    new: str
    tests: str  # ctest -R: tests that may catch it, which run before all others
