"""Many scenes at once: `sweep`."""

from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kvtheory.api._edge import scene_of, times_of
from kvtheory.api._model_error import largest, layer_numbers, notes_of
from kvtheory.api._steady import BODY, LACKS, method_for
from kvtheory.api._transient import MAXIMUM_RTOL, MINIMUM_RTOL
from kvtheory.progress import Progress
from kvtheory.results import SPRING_UNITS, STEADY_UNITS, Sweep
from kvtheory.scene import arguments as argument
from kvtheory.scene.capabilities import lacks_arms, lacks_continuum, lacks_stability, require
from kvtheory.scene.mistakes import SceneError
from kvtheory.scene.model import Scene

if TYPE_CHECKING:
    from kvtheory.sweeps.plan import Plan


@argument.checked(
    executor=argument.pool, jobs=argument.count, in_flight=argument.count, block=argument.count,
    output=argument.file_name, overwrite=argument.flag, progress=argument.callback,
)  # fmt: skip
def sweep(
    scene: Scene | None = None,
    *,
    over: Mapping[Any, Any] | None = None,
    quantities: Sequence[str] | str | None = None,
    at: Any = None,
    method: str | None = None,
    rtol: float = 1e-6,
    executor: Executor | None = None,
    jobs: int = 1,
    in_flight: int | None = None,
    block: int | None = None,
    output: str | Path | None = None,
    overwrite: bool = False,
    progress: Progress | None = None,
) -> Sweep:
    """Solve a scene for many values of some of its quantities.

    A scene that fails is a missing value with its reason in `Sweep.failures`; the sweep goes on.
    The numbers are the same to the last bit for every executor and every size of block; transients on a Prony
    series are so if all of them are compiled.

    Parameters
    ----------
    scene
        What is modelled; without it, the paper's Table 1 with a dead weight. Arrays in it are the first axis:
        they vary together, as they broadcast.
    over
        Maps a dotted key to its values: an array in SI, a list such as ``["10 ms", "1 s"]``, or a text
        ``"1 mm/s:10 m/s:200:log"``. Each key is an axis, and the sweep is over all combinations. A tuple of
        keys with a tuple of lists is one axis on which these values vary together. A ``drive.velocity``
        replaces a history or a waveform; the keys of a waveform, such as ``drive.frequency``, change it.
        Only a scene with arrays may do without.
    quantities
        Steady quantities by name (default: all of them), and ``stable``: 1, or 0 where steady sliding is
        unstable on the spring in the drive (included by default with a spring). Of a transient:
        ``NAME.end``, ``NAME.max``, ``NAME.min`` and ``NAME.time_of_max``, with NAME as in `Transient`;
        ``peak_to_steady_friction``, the largest |F_x| of the run over the steady one; ``settling_time``,
        after which F_x stays within 1 % of the steady one, missing where the run ends before that; ``hops``,
        how often the indenter takes off; ``events``, as JSON. With a spring in the drive
        ``stick_slip_settles`` (1, or 0 where the run shows neither steady sliding nor a limit cycle),
        ``stick_slip_amplitude`` (half the stroke of the indenter along x), ``stick_slip_period``, and
        ``sliding_velocity`` and ``friction_force`` with ``.cycle_max`` and ``.cycle_min``; their errors are
        relative to the cycle itself. With `at`, NAME is the time series; ``NAME.steady`` is always the steady
        value.
        Elements simulate other shapes, and a parabola that `transient` cannot solve on a Prony series, within
        seconds each, the cycle of a ball in more: series, ``NAME.end``, ``NAME.max``, ``NAME.min``,
        ``peak_to_steady_friction`` and the cycle only.
    at, method, rtol
        As in `transient` and `steady`; with `at`, the times of the series.
    executor
        Any `concurrent.futures.Executor`, also of Dask (``Client.get_executor(pure=False)``) or MPI. It is
        not shut down.
    jobs
        Without `executor`, the number of workers: threads or spawned processes, whichever is faster. With
        more than one, a script needs the usual ``if __name__ == "__main__"``.
    in_flight, block
        Blocks submitted at a time, which bounds the memory (default: two for each worker); points in a block.
    output
        A file ``.csv`` or ``.nc``. Finished blocks are kept beside it, in ``FILE.part``, so that the same
        call resumes a sweep that was killed. After an interrupt the file holds what was done.
    overwrite
        Whether to overwrite whatever `output` and its unfinished work hold, including this sweep itself.
        Without it, a file that holds anything else is left unchanged.
    progress
        Called as in `transient`, with the points done, their rate and the failures as text.

    Returns
    -------
    Sweep
        Labelled arrays in SI. With `output`, they are read from the file on access. Its `notes` say how far a
        foundation given by a layer is from the layer itself, and if that is strained beyond linear theory.

    Raises
    ------
    SceneError
        If a key, value, quantity or time is wrong; every mistake is listed.
    ValueError
        If another argument is wrong, if `output` holds anything other than this sweep, or lost rows, or if
        memory or disk cannot hold the result.
    OSError
        If a file cannot be written; finished blocks are kept, and the same call resumes.
    RuntimeError
        If the executor breaks; finished blocks of a file are kept, and the same call resumes.

    Examples
    --------
    >>> import kvtheory as kv
    >>> over = {"drive.velocity": "1 mm/s:10 m/s:3:log", "foundation.retardation_time": ["0.1 s", "1 s"]}
    >>> result = kv.sweep(over=over, quantities="friction_coefficient")
    >>> result["friction_coefficient"].round(4).tolist()
    [[0.0097, 0.0713], [0.0857, 0.0294], [0.0093, 0.003]]

    References
    ----------
    Nakano and Kono (2020), doi:10.3389/fmech.2020.00038; see `steady` and `transient`.
    """
    from kvtheory.sweeps import engine  # what it needs takes a while to import
    from kvtheory.sweeps.plan import refuse_what_cannot_fit

    plan = plan_of(scene, over=over, quantities=quantities, at=at, method=method, rtol=rtol)
    file = None if output is None else Path(output)
    refuse_what_cannot_fit(plan, file)
    how: Any = {"executor": executor, "jobs": jobs, "in_flight": in_flight, "block": block}
    how["report"] = progress
    if file is None:
        found = engine.in_memory(plan, **how)
    else:
        found = engine.into_file(plan, file, overwrite=overwrite, **how)
    return replace(found, notes=notes_of(found.layer, plan.scene, several=True))


def _of_layer(scene: Scene, *contact: Any, **given: Any) -> dict[str, float]:
    """Return the largest numbers of layers from which notes follow; a function by name, for processes."""
    return largest(layer_numbers(scene, *contact, **given))


@argument.checked(
    scene=argument.a_scene, at=argument.times, over=argument.replacements, quantities=argument.names,
    method=argument.choice(LACKS), rtol=argument.number(MINIMUM_RTOL, MAXIMUM_RTOL),
)  # fmt: skip
def plan_of(
    scene: Scene | None = None, *, over: Mapping[Any, Any] | None = None, quantities: Any = None,
    at: Any = None, method: str | None = None, rtol: float = 1e-6,
) -> "Plan":  # fmt: skip
    """Check the arguments of `sweep` together, and return the plan."""
    from kvtheory.sweeps.plan import CYCLE, OF_ELEMENTS, STABLE, Plan, axes_of, columns_of, spread

    scene, over = spread(scene_of(scene), over)
    asked, method = method, "exact" if scene.depths else method_for(scene, method)
    times = None if at is None else tuple(times_of(scene, at))
    axes = axes_of(scene, over)
    for axis in axes:  # one law for all points: with a damper if any of them has one
        if (key := "foundation.damping") in axis.values:
            scene = scene.replace({key: float(axis.values[key].max())})
    sprung = not scene.drive.rigid or any("drive.stiffness" in axis.values for axis in axes)
    on_body = method == BODY
    if quantities is None and at is None and sprung and not (on_body or lacks_stability(scene)):
        quantities = [*STEADY_UNITS, STABLE]
    columns = columns_of(quantities, series=at is not None, indenter=scene.indenter)
    plan = Plan(scene, axes, columns, times, method, rtol, _of_layer)
    if scene.depths and plan.needed(steady=True):
        method_for(scene, asked)  # it refuses
    if on_body and (plan.transient or any(column.base == STABLE for column in columns)):
        raise ValueError('`method` = "layer" gives steady quantities only, without `stable`')
    if plan.transient and lacks_continuum(scene):
        require(lacks_arms, scene, "the transient")
        if lacking := [column.name for column in columns if column.measure not in OF_ELEMENTS]:
            had = "series, NAME.end, NAME.max, NAME.min, peak_to_steady_friction and the cycle"
            why = f"{lacks_continuum(scene)}; `elements` gives {had}"
            raise SceneError([f"`quantities` {', '.join(lacking)}: {why}"])
    for column in columns:
        if not sprung and (column.measure in CYCLE or column.base in SPRING_UNITS):
            raise SceneError([f"`quantities` {column.name}: needs drive.stiffness, of a spring"])
        if column.base == STABLE and sprung:
            require(lacks_stability, scene, "the stability of steady sliding")
    if at is not None and not plan.series:
        raise ValueError("`at` gives the times of series, but no quantity asked for is a series")
    return plan
