"""Pages that follow from the code: each module returns the texts of its pages by their paths."""

from pathlib import Path

from generators import api, atlas, commands, derivations, equations, gallery, keys, problems

PAGES = (api, commands, equations, keys)
ROOT = Path(__file__).parents[2]


def write_all(directory: Path) -> None:
    """Write every page whose text has changed, so that Sphinx reads no other anew.

    The derivations take most of a minute: they are made anew if one of their modules has changed.
    """
    texts = {path: text for module in PAGES for path, text in module.pages().items()}
    proved = directory / "theory" / "index.md"
    changed = max(path.stat().st_mtime for path in (ROOT / "derivations").rglob("*.py"))
    if not proved.exists() or proved.stat().st_mtime < changed:
        texts |= derivations.pages()
    gallery.write(directory)
    texts |= problems.write(directory) | atlas.write(directory)
    for path, text in texts.items():
        target = directory / path
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
