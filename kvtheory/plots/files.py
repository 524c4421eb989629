"""Output files: pictures by suffix, charts with their data beside them, self-contained HTML pages."""

import csv
import io
import json
import logging
import math
import os
import platform
import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import partial
from importlib import metadata
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.font_manager import FontProperties, findfont, get_font

from kvtheory.export import PICTURES, check_path, replace_file, replace_files
from kvtheory.plots.style import STYLE

PACKAGES = "kvtheory", "numpy", "scipy", "numba", "scikit-sundae"
"""The packages whose versions are recorded with a chart."""
METADATA = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
"""No dates, so that the same figure is the same file."""
LEAST_FONT, CLOSER = 5.0, 1.5
"""Smallest font, in points, of a table in a small figure; how much closer its rows may be, for their font."""
LONGEST = 300
"""Characters of a message that are shown: LaTeX adds all of its output."""
LETTERS = "labelsize", "titlesize", "fontsize"
"""Ends of the names of settings that follow the font size."""
Write = Callable[[Path], Any]
"""Writes a file."""


def save_picture(
    draw: Callable[[], Any], *pictures: Path, beside: Mapping[Path, Write] = MappingProxyType({}),
    style: Any = None,
) -> None:  # fmt: skip
    """Draw a figure, and write it in the formats of the suffixes, with the files `beside` it: all, or none.

    A size in the `style` of a user replaces that of the figure, and `font.size` is that of all letters. Where
    matplotlib fails with that style, or warns of axes without room or of fonts and letters that are missing,
    `ValueError` is raised.
    """
    for path in pictures:
        check_path(path, PICTURES)
    own = style or {}
    larger = own.get("font.size", STYLE["font.size"]) / STYLE["font.size"]
    sizes = {key: larger * STYLE[key] for key in STYLE if key.endswith(LETTERS)}
    with (
        mpl.rc_context({**STYLE, **sizes, **own}),
        warnings.catch_warnings(),
        _logged() as messages,
    ):
        if style:
            warnings.simplefilter("error", UserWarning)
            warnings.simplefilter("error", RuntimeWarning)
        try:
            drawn = draw()
            drawn.set_size_inches(own.get("figure.figsize", drawn.get_size_inches()))
            if layout := drawn.get_layout_engine():
                layout.execute(drawn)
            _fit_tables(drawn)
            # laid out once, or each format would draw everything twice
            drawn.set_layout_engine(None)
            said = messages if style else []
            writers = {path: partial(_save, drawn, path.suffix.lower(), said) for path in pictures}
            replace_files({**writers, **beside})
        except (
            ArithmeticError,
            MemoryError,
            RuntimeError,
            TypeError,
            ValueError,
            Warning,
        ) as error:
            if not style:
                raise
            words = " ".join(str(error).split())[:LONGEST]
            raise ValueError(f"`style`: matplotlib cannot draw with it: {words}") from None


def _fit_tables(drawn: Any) -> None:
    """Shrink tables, which no layout does, to the width and height of their axes, or raise `ValueError`."""
    for table in (each for ax in drawn.axes for each in ax.tables):
        size, box, room = table[0, 0].get_fontsize(), table.get_window_extent(), table.axes.bbox
        wide, high = room.width / box.width, room.height / box.height
        share = min(wide, CLOSER * high, 1.0)
        if size * share < LEAST_FONT:
            least = (each * LEAST_FONT / (size * share) + 0.05 for each in drawn.get_size_inches())
            message = "the table needs a figure.figsize of {:.1f}, {:.1f} in at least"
            raise ValueError(message.format(*least))
        table.set_fontsize(size * share)
        table.scale(1.0, min(share, high))


def _save(drawn: Any, suffix: str, messages: list[str], part: Path) -> None:
    """Write a figure, or raise `ValueError` with what matplotlib has to say about it."""
    drawn.savefig(part, metadata=METADATA.get(suffix))
    if messages:
        raise ValueError(messages[0])


def drawable(text: str) -> bool:
    r"""Whether the font of the package has all letters of a text.

    >>> drawable("Euler, µs"), drawable("\u4e2d")
    (True, False)
    """
    with mpl.rc_context({**STYLE}):
        font = get_font(findfont(FontProperties()))
    return all(font.get_char_index(ord(letter)) for letter in text)


def data_csv(path: Path, columns: Mapping[str, Any]) -> dict[Path, Write]:
    """Return a CSV beside a picture: its columns by their heads."""

    def write(part: Path) -> None:
        with part.open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(columns)
            for row in zip(*(np.asarray(each).tolist() for each in columns.values()), strict=True):
                missing = (isinstance(cell, float) and math.isnan(cell) for cell in row)
                writer.writerow("" if no else cell for no, cell in zip(missing, row, strict=True))

    return {path.with_suffix(".csv"): write}


def data_json(path: Path, data: Mapping[str, Any]) -> dict[Path, Write]:
    """Return a JSON file beside a picture: its data, with machine and versions."""
    text = json.dumps({"environment": environment(), **data}, indent=1, allow_nan=False)
    return {path.with_suffix(".json"): lambda part: save_page(text + "\n", part)}


@contextmanager
def _logged() -> Iterator[list[str]]:
    """Give the messages that matplotlib logs, which are not printed then."""
    messages: list[str] = []
    handler, log = logging.Handler(logging.WARNING), logging.getLogger("matplotlib")
    handler.emit = lambda record: messages.append(record.getMessage())  # type: ignore[method-assign]
    log.addHandler(handler)
    try:
        yield messages
    finally:
        log.removeHandler(handler)


def read_style(path: Path) -> Any:
    """Return the settings of a style sheet of matplotlib, or raise `ValueError` with what it cannot read."""
    with _logged() as messages:
        try:
            found = mpl.rc_params_from_file(
                str(path), fail_on_error=True, use_default_template=False
            )
        except (ValueError, KeyError, UnicodeDecodeError) as error:
            messages.append(str(error))
    if messages:
        raise ValueError(f'`style` "{path}": {" ".join(messages[0].split())}')
    return found


def environment() -> dict[str, str | int]:
    """Return machine, processors, and versions; a package that is not installed is ``"-"``.

    >>> sorted(environment())[:3]
    ['kvtheory', 'machine', 'numba']
    """
    versions, processor = dict.fromkeys(PACKAGES, "-"), platform.processor()
    for name in PACKAGES:
        with suppress(metadata.PackageNotFoundError):
            versions[name] = metadata.version(name)
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
        processor = next(names, processor)
    return {
        "machine": platform.machine(),
        "system": platform.system(),
        "processor": processor,
        "processors": os.cpu_count() or 1,
        "python": platform.python_version(),
        **versions,
    }


def inline(draw: Callable[[], Any], key: str) -> str:
    """Return the figure that `draw` makes as an SVG element, whose ids begin with a key of its own."""
    with mpl.rc_context({**STYLE}):
        text = io.StringIO()
        draw().savefig(text, format="svg", metadata={"Date": None})
    drawn = text.getvalue()
    return re.sub(r'(\bid="|href="#|url\(#)', rf"\g<1>{key}", drawn[drawn.index("<svg") :])


def template(name: str) -> str:
    """Return the template of a page or of a part of it, with names in braces to be filled in."""
    return files("kvtheory.plots").joinpath(name).read_text(encoding="utf-8")


def save_page(text: str, path: Path) -> None:
    """Write a page of HTML, or any text."""
    replace_file(path, lambda part: part.write_text(text, encoding="utf-8"))
