"""The explorer as one HTML file: its scripts, its formulas and a scene; it loads no other file."""

import json
import re
import tomllib
from importlib.resources import files
from pathlib import Path

from kvtheory.explorer.controls import controls
from kvtheory.export import check_path, replace_file
from kvtheory.scene.capabilities import LAWS, lacks_one_scene, lacks_scripts, require
from kvtheory.scene.model import Scene

SCRIPTS = (
    "closed_forms", "steady", "ball", "circle", "stability", "rubber", "motion", "scene",
    "layer", "charts", "contact", "answers", "playing", "explorer",
)  # fmt: skip
"""In order: each uses only earlier ones."""
QUANTITY = re.compile(r"@(\*|[A-Za-z]+(?:_[a-z0-9])?)")


def save_explorer(scene: Scene, path: str | Path) -> None:
    """Write the explorer, opened at a scene, as one HTML file without server and network, or raise."""
    path = Path(path)
    check_path(path, [".html"])
    page = explorer_page(scene)
    replace_file(path, lambda part: part.write_text(page, encoding="utf-8"))


def explorer_page(scene: Scene) -> str:
    """Return the text of the page, or raise ValueError if its scripts cannot compute the scene, or arrays.

    >>> explorer_page(Scene()).startswith("<!DOCTYPE html>")
    True
    """
    from kvtheory import __version__

    require(lacks_one_scene, scene, "the explorer")
    require(lacks_scripts, scene, "the explorer")
    if (kind := scene.foundation.kind) not in LAWS:
        raise ValueError(f'the explorer has no sliders for foundation.kind = "{kind}"')
    data = {"version": __version__, "formulas": formulas(), **controls(scene)}
    parts = {
        "style": _text("explorer.css"),
        "script": "\n".join(_text(f"{name}.js") for name in SCRIPTS),
        "data": json.dumps(data, ensure_ascii=False, separators=(",", ":")).replace("</", r"<\/"),
        "version": __version__,
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda found: parts[found[1]], _text("explorer.html"))


def formulas() -> dict[str, dict[str, str]]:
    """Return each formula as MathML: once with symbols, and once with placeholders for numbers."""
    from latex2mathml.converter import convert

    table = tomllib.loads(_text("formulas.toml"))
    symbols = {"*": r"\,", **table.pop("symbols")}
    places = {**{name: rf"\text{{#{name}#}}" for name in symbols}, "*": r"\cdot "}

    def written(latex: str, names: dict[str, str]) -> str:
        def name(found: re.Match[str]) -> str:
            return names["*"] if found[1] == "*" else f"{{{names[found[1]]}}}"

        made = convert(QUANTITY.sub(name, latex))
        return made.replace("<math ", '<math displaystyle="true" ', 1)

    return {
        key: {
            "label": row["label"],
            "where": row.get("where", ""),
            "symbols": written(row["latex"], symbols),
            "numbers": written(row["latex"], places),
        }
        for key, row in table.items()
    }


def _text(name: str) -> str:
    return files("kvtheory.explorer").joinpath(name).read_text(encoding="utf-8")
