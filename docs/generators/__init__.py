"""Pages that follow from the code: each module returns the texts of its pages by their paths."""

from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path

from generators import (
    api,
    atlas,
    capabilities,
    commands,
    derivations,
    equations,
    gallery,
    keys,
    problems,
)

QUICK = (api, capabilities, commands, equations, keys)
ROOT = Path(__file__).parents[2]


def write_all(directory: Path) -> None:
    """Write every page whose text has changed, so that Sphinx reads only these again.

    The slow pages are made by two processes at the same time, and only if they are missing; the
    derivations also if one of their modules, or one of these, has changed.
    """
    directory.mkdir(exist_ok=True)
    proved = directory / "theory" / "index.md"
    sources = (*(ROOT / "derivations").rglob("*.py"), *Path(__file__).parent.glob("*.py"))
    changed = max(path.stat().st_mtime for path in sources)
    with ProcessPoolExecutor(2) as pool:
        anew = not proved.exists() or proved.stat().st_mtime < changed
        slow = {pool.submit(derivations.pages): "derivations"} if anew else {}
        slow |= {
            pool.submit(module.write, directory): module.__name__.rpartition(".")[2]
            for module in (problems, atlas)
        }
        drawn = {pool.submit(gallery.draw, name, directory): name for name in gallery.HERE}
        jobs = slow | drawn
        print(f"Making pages and figures: {', '.join(jobs.values())}", flush=True)
        texts = {path: text for module in QUICK for path, text in module.pages().items()}
        gallery.write(directory)
        for done, job in enumerate(as_completed(jobs), start=1):
            made = job.result()
            texts |= made if job in slow else {}
            print(f"{done} of {len(jobs)}: {jobs[job]}", flush=True)
    for path, text in texts.items():
        target = directory / path
        if not target.exists() or target.read_text(encoding="utf-8") != text:
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_text(text, encoding="utf-8")
