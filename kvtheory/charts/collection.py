"""The choice of charts of speed against accuracy: for a user's scene or for the standard ones."""

from collections.abc import Callable, Sequence
from functools import partial

from kvtheory.charts.problems import STANDARD, Problem, standard_scene
from kvtheory.charts.steady_precision import VELOCITIES, steady_chart, suits
from kvtheory.charts.work_precision import FULL, QUICK, Chart, transient_chart
from kvtheory.progress import Progress, silent
from kvtheory.scene.capabilities import lacks_rigid_paper_model, require
from kvtheory.scene.drives import Drive
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import nearest

Job = Callable[..., Chart]
"""Makes one chart, with an `effort`, and reports its `progress`."""
ALL = "all"


def chosen(scene: Scene, standard: Sequence[str], *, quick: bool) -> list[Job]:
    """Return a job for each chart: of the standard scenes that are named, or else of the scene.

    If a scene has a suitable steady state, its chart comes before that of the transient.

    Raises
    ------
    ValueError
        If there is no such standard scene, or the indenter is not a parabola.
    """
    for name in standard:
        if name not in (*STANDARD, ALL):
            raise ValueError(f'`standard` "{name}": {nearest(name, (*STANDARD, ALL))}')
    require(lacks_rigid_paper_model, scene, "the chart of transients")
    scenes = [("this scene", scene, scene)]
    if standard:
        names = list(STANDARD) if ALL in standard else standard
        scenes = [(name, _sliding(name), standard_scene(name)) for name in names]
    jobs: list[Job] = []
    for name, sliding, moving in scenes:
        if suits(sliding):
            jobs.append(partial(steady_chart, sliding, f"{name}, steady"))
        jobs.append(partial(transient_chart, Problem(name, moving, quick)))
    return jobs


def _sliding(name: str) -> Scene:
    """Return the scene of steady sliding for a standard scene, which may not be suitable."""
    if name in VELOCITIES:
        return Scene(drive=Drive(velocity=VELOCITIES[name]))
    return standard_scene(name)


def measure(jobs: Sequence[Job], *, quick: bool, progress: Progress = silent) -> list[Chart]:
    """Make the charts, one after the other, so that nothing disturbs the times."""
    charts = []
    for done, job in enumerate(jobs):

        def report(share: float, words: str, done: int = done) -> None:
            progress((done + share) / len(jobs), words)

        charts.append(job(effort=QUICK if quick else FULL, progress=report))
    return charts
