"""The reference problems by name: each is a scene file whose first lines describe it."""

from itertools import takewhile
from pathlib import Path

from kvtheory.scene import Scene, load_scene
from kvtheory.scene.mistakes import mistake, nearest

SCENES = {path.stem: path for path in sorted(Path(__file__).with_name("scenes").glob("*.toml"))}
"""The scene files by the names of the problems."""


def problems() -> dict[str, str]:
    """Return the names of the reference problems, and a line about each.

    There is one for each regime, support, shape, foundation and kind of drive; `problem` returns its scene.

    Examples
    --------
    >>> problems()["take-off"]
    'The indenter takes off'
    """
    return {name: _description(name)[0].removesuffix(".") for name in SCENES}


def problem(name: str) -> Scene:
    """Return the scene of a reference problem.

    Raises
    ------
    ValueError
        If there is no problem of this name; the message names the nearest.

    Examples
    --------
    >>> problem("paper-fixed").support
    Fixed(depth=0.0003)
    """
    return load_scene(_file(name))


def problem_text(name: str) -> str:
    """Return the text of the scene file of a reference problem, or raise as `problem` does."""
    return _file(name).read_text(encoding="utf-8")


def about(name: str) -> str:
    """Return the description of a reference problem, in a sentence or two.

    >>> about("wedge")
    'Beyond its crossover the friction coefficient is the slope of the wedge exactly.'
    """
    return " ".join(_description(name)[1:])


def _description(name: str) -> list[str]:
    lines = takewhile(lambda line: line.startswith("#"), problem_text(name).splitlines())
    return [line.removeprefix("# ") for line in lines]


def _file(name: str) -> Path:
    if not (isinstance(name, str) and name in SCENES):
        raise mistake("`problem`", name, nearest(str(name), SCENES))
    return SCENES[name]
