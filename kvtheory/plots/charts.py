"""A chart as a file: the picture, and what it was drawn from as JSON beside it."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from kvtheory.charts.environment import environment
from kvtheory.plots.style import STYLE


def save_chart(draw: Callable[[], Any], data: Mapping[str, Any], path: Path) -> None:
    """Draw and write the picture as the suffix of `path` says, and the data with machine and versions."""
    import matplotlib as mpl

    from kvtheory.export import replace_file

    text = json.dumps({"environment": environment(), **data}, indent=1, allow_nan=False)
    with mpl.rc_context({**STYLE}):
        replace_file(path, draw().savefig)
    replace_file(path.with_suffix(".json"), lambda part: part.write_text(text + "\n"))
