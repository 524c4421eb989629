"""A chart as a file: the picture, and what it was drawn from as JSON beside it."""

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from kvtheory.charts.environment import environment
from kvtheory.export import replace_file
from kvtheory.plots.files import save_picture


def save_chart(draw: Callable[[], Any], data: Mapping[str, Any], path: Path) -> None:
    """Draw and write the picture as the suffix of `path` says, and the data with machine and versions."""
    text = json.dumps({"environment": environment(), **data}, indent=1, allow_nan=False)
    save_picture(draw, path)
    replace_file(path.with_suffix(".json"), lambda part: part.write_text(text + "\n"))
