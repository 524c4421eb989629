"""The folders of the reference problems: `python -m figures.reference_problems [-o DIRECTORY] [NAME ...]`."""

import argparse
from collections.abc import Iterable
from pathlib import Path

import kvtheory as kv
from kvtheory.api._problem_folder import write_problem

OUTPUT = Path("paper/problems")


def main(arguments: Iterable[str] | None = None) -> None:
    """Write the folders, each with a picture of the reference."""
    parser = argparse.ArgumentParser(
        prog="python -m figures.reference_problems", description=__doc__
    )
    parser.add_argument("-o", "--output", type=Path, default=OUTPUT, help="default: %(default)s")
    parser.add_argument("names", nargs="*", metavar="NAME", help="default: all")
    given = parser.parse_args(None if arguments is None else list(arguments))
    for name in given.names or kv.problems():
        print(write_problem(name, given.output / name), flush=True)


if __name__ == "__main__":
    main()
