"""Pages that follow from the code: each module returns the texts of its pages, or writes its files.

What takes seconds is made again only where the code has changed, by two processes. The tests make most of it
too, and keep it for the site where `KVTHEORY_SITE` names the directory, as `make test` does.
"""

import hashlib
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import cache, partial
from pathlib import Path

import kvtheory as kv
from generators import (
    api,
    atlas,
    capabilities,
    commands,
    derivations,
    equations,
    gallery,
    keys,
    problems,
)
from generators.files import put

ROOT = Path(__file__).parents[2]
CODE = ("derivations", "figures", "kvtheory", "docs/generators")
QUICK = (api, capabilities, commands, equations, keys)
SLOW: dict[str, Callable[[Path], None]] = {
    "derivations": derivations.write,
    "atlas": atlas.write,
    **{f"problem {name}": partial(problems.write, name=name) for name in kv.problems()},
    **{f"figure {name}": partial(gallery.draw, name=name) for name in gallery.HERE},
}
"""What is made by a function of the directory."""


@cache
def digest() -> str:
    """Return the digest of all code."""
    found = hashlib.sha256()
    for path in sorted(path for folder in CODE for path in (ROOT / folder).rglob("*")):
        if path.is_file() and "__pycache__" not in path.parts:
            found.update(f"{path.relative_to(ROOT)}\n".encode() + path.read_bytes())
    return found.hexdigest()


def stamp(name: str, directory: Path) -> Path:
    """Return the file that holds the digest of the code that made something."""
    return directory / "made" / name.replace(" ", "-")


def is_fresh(name: str, directory: Path) -> bool:
    """Whether it has been made by the code as it is."""
    path = stamp(name, directory)
    return path.exists() and path.read_text(encoding="utf-8") == digest()


def made(name: str, directory: Path) -> None:
    """Note that it has been made by the code as it is."""
    put(stamp(name, directory), digest())


def make(name: str, directory: Path) -> None:
    """Make one of `SLOW`."""
    SLOW[name](directory)
    made(name, directory)


def write_all(directory: Path) -> None:
    """Write every page."""
    due = [name for name in SLOW if not is_fresh(name, directory)]
    print(f"Making {', '.join(due) or 'nothing anew'}", flush=True)
    with ProcessPoolExecutor(2) as pool:
        jobs = {pool.submit(make, name, directory): name for name in due}
        problems.write_index(directory)
        gallery.write(directory)
        for path, text in (page for module in QUICK for page in module.pages().items()):
            put(directory / path, text)
        for count, job in enumerate(as_completed(jobs), start=1):
            job.result()
            print(f"{count} of {len(jobs)}: {jobs[job]}", flush=True)
