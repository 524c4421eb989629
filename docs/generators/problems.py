"""The reference problems as pages, each with its folder to download; and the explorer."""

import os
import shutil
from pathlib import Path

import kvtheory as kv
from figures.reference_problems import write as write_folder
from kvtheory.explorer import save_explorer


def write(directory: Path) -> dict[str, str]:
    """Write the folders that are missing, and return the texts of the pages."""
    extra = directory / "extra"
    extra.mkdir(parents=True, exist_ok=True)
    (directory / "static").mkdir(exist_ok=True)
    save_explorer(kv.Scene(), extra / "explorer.html")
    texts = {"problems/index.md": _index()}
    for name in kv.problems():
        folder, archive = directory / "folders" / name, extra / "problems" / f"{name}.zip"
        if not archive.exists():
            write_folder(name, folder.parent)
            archive.parent.mkdir(exist_ok=True)
            shutil.make_archive(str(archive.with_suffix("")), "zip", folder.parent, name)
        page = (folder / "README.md").read_text(encoding="utf-8")
        picture = os.path.relpath(folder / "reference.png", directory / "problems")
        texts[f"problems/{name}.md"] = (
            page.replace("(reference.png)", f"({Path(picture).as_posix()})")
            + f'\n<a href="../../problems/{name}.zip">The folder as an archive</a>\n'
        )
    return texts


def _index() -> str:
    rows = "\n".join(
        f"| [{title}]({name}.md) | `{name}` |" for name, title in kv.problems().items()
    )
    names = "\n".join(kv.problems())
    return f"{_HEAD}\n| scene | name |\n|---|---|\n{rows}\n\n```{{toctree}}\n:hidden:\n\n{names}\n```\n"


_HEAD = """# Reference problems

Named scenes for testing a method or your own simulator: one for each regime, support,
shape, foundation and drive. Each folder has the scene, a reference solution with its certificate, acceptance
criteria, a picture and a short test script; copy it into your repository. `kvtheory scene --problem NAME`
prints a scene, `kv.problem("NAME")` loads it.
"""
