"""The reference problems as pages, each with its folder to download; and the explorer."""

import os
import shutil
from pathlib import Path

import kvtheory as kv
from generators.files import put
from kvtheory.api._problem_folder import write_problem
from kvtheory.explorer import save_explorer


def write(directory: Path, name: str) -> None:
    """Write the folder of a problem, its archive and its page."""
    folder, archive = directory / "folders" / name, directory / "extra" / "problems" / f"{name}.zip"
    write_problem(name, folder)
    archive.parent.mkdir(parents=True, exist_ok=True)
    shutil.make_archive(str(archive.with_suffix("")), "zip", folder.parent, name)
    page = (folder / "README.md").read_text(encoding="utf-8")
    picture = Path(os.path.relpath(folder / "reference.png", directory / "problems")).as_posix()
    link = f'\n<a href="../../problems/{name}.zip">The folder as an archive</a>\n'
    put(
        directory / "problems" / f"{name}.md",
        page.replace("(reference.png)", f"({picture})") + link,
    )


def write_index(directory: Path) -> None:
    """Write the list of all problems, and the explorer."""
    (directory / "extra").mkdir(parents=True, exist_ok=True)
    save_explorer(kv.Scene(), directory / "extra" / "explorer.html")
    put(directory / "problems" / "index.md", _index())


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
prints a scene, with `-o FOLDER` it writes the folder; `kv.problem("NAME")` loads it.
"""
