"""Which charts of speed against accuracy are made, of a user's scene or of the standard ones."""

from collections.abc import Callable, Sequence

from kvtheory.charts.problems import STANDARD, Problem, standard_scene
from kvtheory.charts.steady_precision import VELOCITIES, steady_chart, suits
from kvtheory.charts.work_precision import FULL, QUICK, Chart, Effort, transient_chart
from kvtheory.scene.drives import Drive
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import nearest
from kvtheory.scene.requirements import require_parabola

Job = Callable[[Effort, Callable[[float], object]], Chart]
"""Makes one chart."""
ALL = "all"


def chosen(scene: Scene, standard: Sequence[str], *, quick: bool) -> list[Job]:
    """Return a job for each chart: of the standard scenes that are named, or else of the scene.

    Where a scene has a steady state that suits, its chart comes before that of the transient.

    Raises
    ------
    ValueError
        If there is no such standard scene, or the indenter is not a parabola.
    """
    for name in standard:
        if name not in (*STANDARD, ALL):
            raise ValueError(f'`standard` "{name}": {nearest(name, (*STANDARD, ALL))}')
    require_parabola(scene, "the chart of transients")
    if not standard:
        return [*_steady(scene, "this scene"), _transient(Problem("this scene", scene, quick))]
    names = list(STANDARD) if ALL in standard else standard
    jobs = []
    for name in names:
        if name in VELOCITIES:
            jobs += _steady(Scene(drive=Drive(velocity=VELOCITIES[name])), name)
        jobs.append(_transient(Problem(name, standard_scene(name), quick)))
    return jobs


def measure(
    jobs: Sequence[Job], *, quick: bool, progress: Callable[[float], object] | None = None
) -> list[Chart]:
    """Make the charts, one after the other, so that nothing disturbs the times."""
    charts = []
    for done, job in enumerate(jobs):

        def report(share: float, done: int = done) -> None:
            if progress is not None:
                progress((done + share) / len(jobs))

        charts.append(job(QUICK if quick else FULL, report))
    return charts


def _steady(scene: Scene, name: str) -> list[Job]:
    if not suits(scene):
        return []
    return [
        lambda effort, report: steady_chart(
            scene, f"{name}, steady", effort=effort, progress=report
        )
    ]


def _transient(problem: Problem) -> Job:
    return lambda effort, report: transient_chart(problem, effort=effort, progress=report)
