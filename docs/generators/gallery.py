"""The figures as a gallery: each script a page with its picture. Slow figures are drawn beforehand."""

import re
import shutil
from importlib import import_module
from pathlib import Path
from typing import Any

from figures import drawing
from figures.__main__ import FIGURES, TOPICS
from generators.files import put

ROOT = Path(__file__).parents[2]
DRAWN = ("onset_maps", "stability_map", "work_precision")
"""Copied from the folder of the scripts: they take minutes, or are measurements of time."""
HERE = [name for name in FIGURES if name not in DRAWN]
"""Drawn for the site."""
DPI = 130
_made: list[Path] = []


def patch(directory: Path) -> None:
    """Let a script, which serves as a command line, hand its picture to the gallery instead."""

    def run(name: str, compute: Any, draw: Any) -> None:
        kept = ROOT / "figures" / f"{name}.png"
        _made.append(kept if name in DRAWN else directory / "pictures" / kept.name)

    drawing.run = run


def draw(directory: Path, name: str) -> None:
    """Draw one figure."""
    import matplotlib as mpl

    from kvtheory.plots import STYLE

    script, folder = import_module(f"figures.{name}"), directory / "pictures"
    folder.mkdir(parents=True, exist_ok=True)
    with mpl.rc_context({**STYLE, "savefig.dpi": DPI}):
        script.draw(script.compute()).savefig(folder / f"{name}.png")


def pictures(block: Any, variables: dict[str, Any], settings: dict[str, Any]) -> str:
    """Return what the gallery shows of a script: the picture that it drew."""
    from sphinx_gallery.scrapers import figure_rst

    paths = []
    while _made:
        target = Path(next(variables["image_path_iterator"]))
        shutil.copy(_made.pop(0), target)
        paths.append(str(target))
    return figure_rst(paths, settings["src_dir"]) if paths else ""


def write(directory: Path) -> None:
    """Write the scripts that have changed, titled as the gallery requires, in a folder for each topic."""
    put(directory / "scripts" / "README.rst", _HEAD)
    for number, (topic, names) in enumerate(TOPICS.items(), start=1):
        folder = directory / "scripts" / f"{number}-{topic.split()[-1].lower()}"
        put(folder / "README.rst", f"{topic}\n{'-' * len(topic)}\n")
        for name in names:
            text = (ROOT / "figures" / f"{name}.py").read_text(encoding="utf-8")
            titled = re.sub(r'\A"""(.*?)"""', _titled, text, count=1, flags=re.DOTALL)
            put(folder / f"{name}.py", titled)


def order(file: str) -> int:
    """Return the place of a script in the gallery: the order in which the figures are drawn."""
    return FIGURES.index(Path(file).stem)


def _titled(found: re.Match[str]) -> str:
    title, _, rest = found[1].strip().partition("\n\n")
    title = title.replace("\n", " ").rstrip(".")
    rest = re.sub(r"`([^`]+)`", r"``\1``", rest)
    return f'"""\n{title}\n{"=" * len(title)}\n\n{rest}\n"""'


_HEAD = """Figures
=======

Each script is in the folder ``figures`` of the repository; ``python -m figures.NAME`` draws it and writes
its data as CSV. Those of the paper need no checkout, and show any scene in any style: ``kvtheory chart fig6
my-scene.toml --style mine.mplstyle -o fig6.pdf``. Maps that take minutes, and measurements of time, are the
stored pictures of the repository.

"""
