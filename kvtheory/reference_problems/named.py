"""The reference problems by name: each is a scene file whose first lines describe it."""

from functools import cache
from importlib.resources import as_file, files
from itertools import takewhile

from kvtheory.scene import Scene, load_scene
from kvtheory.scene.quantities import mistake, nearest

SCENES = "scenes"


@cache
def _names() -> tuple[str, ...]:
    paths = files("kvtheory.reference_problems").joinpath(SCENES).iterdir()
    return tuple(sorted(path.name.removesuffix(".toml") for path in paths))


def problems() -> dict[str, str]:
    """Return the names of the reference problems, and a line about each.

    There is one for each regime, support, shape, foundation and kind of drive; `problem` returns its scene.

    Examples
    --------
    >>> problems()["take-off"]
    'The indenter takes off'
    """
    return {name: _told(problem_text(name))[0].removesuffix(".") for name in _names()}


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
    problem_text(name)
    with as_file(files("kvtheory.reference_problems").joinpath(SCENES, f"{name}.toml")) as path:
        return load_scene(path)


def problem_text(name: str) -> str:
    """Return the text of the scene file of a reference problem, whose first lines describe it.

    Raises
    ------
    ValueError
        If there is no problem of this name.
    """
    if not (isinstance(name, str) and name in _names()):
        raise mistake("`problem`", name, nearest(str(name), _names()))
    found = files("kvtheory.reference_problems").joinpath(SCENES, f"{name}.toml")
    return found.read_text(encoding="utf-8")


def about(name: str) -> str:
    """Return the description of a reference problem, in a sentence or two.

    >>> about("wedge")
    'Beyond its crossover the friction coefficient is the slope of the wedge exactly.'
    """
    return " ".join(_told(problem_text(name))[1:])


def _told(text: str) -> list[str]:
    lines = takewhile(lambda line: line.startswith("#"), text.splitlines())
    return [line.removeprefix("# ") for line in lines]
