"""Files of the site."""

from pathlib import Path


def put(path: Path, text: str) -> None:
    """Write a text unless it is there already: Sphinx reads again what is younger than its page."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text(encoding="utf-8") != text:
        path.write_text(text, encoding="utf-8")
