"""Choose the work-precision charts to make: for a user's scene or for the standard scenes."""

from collections.abc import Callable, Sequence
from functools import partial

from kvtheory.charts.methods import transient_methods
from kvtheory.charts.problems import STANDARD, Problem, standard_scene
from kvtheory.charts.steady_precision import SteadyProblem, steady_methods, suits
from kvtheory.charts.work_precision import FULL, QUICK, Chart, make_chart
from kvtheory.progress import Progress, silent
from kvtheory.scene import Drive, Scene
from kvtheory.scene.capabilities import lacks_one_scene, lacks_rigid_continuum, require
from kvtheory.scene.mistakes import nearest

Job = Callable[..., Chart]
"""Makes one chart, with an `effort`, and reports its `progress`."""
ALL = "all"
VELOCITIES = {"table-1": 0.1, "low-velocity": 1e-3, "high-velocity": 10.0}
"""Velocity (m/s) in steady sliding of the standard scenes that otherwise equal Table 1."""


def chosen(scene: Scene, standard: Sequence[str], *, quick: bool) -> list[Job]:
    """Return a job for each chart, steady sliding first: for standard scenes, or for the scene."""
    for name in standard:
        if name not in (*STANDARD, ALL):
            raise ValueError(f'`standard` "{name}": {nearest(name, (*STANDARD, ALL))}')
    require(lacks_one_scene, scene, "the chart")
    require(lacks_rigid_continuum, scene, "the chart of transients")
    jobs: list[Job] = []
    for name in STANDARD if ALL in standard else standard or ("this scene",):
        sliding = scene if suits(scene) and not standard else None
        if name in VELOCITIES:
            sliding = Scene(drive=Drive(velocity=VELOCITIES[name]))
        if sliding:
            steady = SteadyProblem(f"{name}, steady", sliding)
            jobs.append(partial(make_chart, steady, steady_methods()))
        transient = Problem(name, standard_scene(name) if standard else scene, quick)
        jobs.append(partial(make_chart, transient, transient_methods().values()))
    return jobs


def measure(jobs: Sequence[Job], *, quick: bool, progress: Progress = silent) -> list[Chart]:
    """Make the charts one after the other, so that nothing disturbs the timings."""
    charts = []
    for done, job in enumerate(jobs):

        def report(share: float, words: str, done: int = done) -> None:
            progress((done + share) / len(jobs), words)

        charts.append(job(effort=QUICK if quick else FULL, progress=report))
    return charts
