"""`python -m kvtheory` is the command `kvtheory`."""

from kvtheory.cli import main

if __name__ == "__main__":
    main(prog_name="kvtheory")
