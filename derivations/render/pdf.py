"""The LaTeX article set by pdflatex."""

import shutil
import subprocess
from pathlib import Path
from tempfile import TemporaryDirectory

_ENGINE = "pdflatex"
_MOST_RUNS = 5
"""Contents, links and page numbers settle after three runs; more would never settle."""
_JOB = "derivations"
_REPRODUCIBLE = r"\pdfinfoomitdate=1 \pdftrailerid{}"
"""No date and no path of the machine in the file: the same source gives the same bytes."""


class RenderError(RuntimeError):
    """A document cannot be made: no LaTeX engine, or mathematics that a format cannot show."""


def latex_engine() -> str | None:
    """Return the path of the LaTeX engine, or None where there is none."""
    return shutil.which(_ENGINE)


def require_engine() -> str:
    """Return the path of the LaTeX engine, or raise `RenderError` where there is none."""
    engine = latex_engine()
    if engine is None:
        raise RenderError(
            f"no LaTeX engine ({_ENGINE}) on PATH; install texlive-latex-base "
            "or leave pdf out of --format"
        )
    return engine


def typeset(source: str) -> tuple[bytes, str]:
    """Return the PDF of a LaTeX document and the log of the last run.

    Raises
    ------
    RenderError
        Where no LaTeX engine is found, or the engine reports an error.
    """
    engine = require_engine()
    with TemporaryDirectory() as name:
        directory = Path(name)
        (directory / f"{_JOB}.tex").write_text(source, encoding="utf-8")
        before: dict[str, bytes] = {}
        for _ in range(_MOST_RUNS):
            log = _run(engine, directory)
            after = {path.name: path.read_bytes() for path in directory.glob(f"{_JOB}.[ato]*")}
            if after == before:
                return (directory / f"{_JOB}.pdf").read_bytes(), log
            before = after
    raise RenderError(f"{_ENGINE}: references still change after {_MOST_RUNS} runs")


def _run(engine: str, directory: Path) -> str:
    arguments = ["-no-shell-escape", "-interaction=nonstopmode", "-halt-on-error"]
    done = subprocess.run(
        [engine, *arguments, f"-jobname={_JOB}", rf"{_REPRODUCIBLE}\input{{{_JOB}.tex}}"],
        cwd=directory,
        capture_output=True,
        check=False,
    )
    log_file = directory / f"{_JOB}.log"
    log = log_file.read_text(encoding="utf-8", errors="replace") if log_file.exists() else ""
    if done.returncode:
        _, _, error = log.partition("\n! ")
        raise RenderError(f"{_ENGINE}: {error[:300].strip() or done.stdout[-300:]!r}")
    return log
