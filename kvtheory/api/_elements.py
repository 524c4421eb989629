"""The discrete simulator: `elements`."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from kvtheory.api._edge import double_precision, noted, one_scene, times_of
from kvtheory.progress import Progress
from kvtheory.results import Simulation, SprungSimulation
from kvtheory.results.table import SIMULATED
from kvtheory.scene.arguments import a_scene, callback, checked, choice, flag, measured, times
from kvtheory.scene.model import Scene
from kvtheory.scene.quantities import Quantity

DENSITY = 200e3
"""Elements per metre, as in the paper."""
PER_LENGTH = Quantity("1/m", "N, elements per unit length", 0.0, True)
TIME_STEP = Quantity("s", "time step", 0.0, True)


@checked(
    scene=a_scene, at=times, per_length=measured(PER_LENGTH), scheme=choice(SIMULATED),
    time_step=measured(TIME_STEP), certify=flag, progress=callback, warn=callback,
)  # fmt: skip
def elements(
    scene: Scene | None = None,
    *,
    per_length: Any = None,
    scheme: str = "edge-corrected",
    at: Any = None,
    time_step: Any = None,
    certify: bool = True,
    progress: Progress | None = None,
    warn: Callable[[str], None] | None = None,
) -> Simulation:
    """Simulate a scene by point elements that move with the base: any shape, support and drive.

    The foundation is Kelvin-Voigt or a Prony series. A ball, or any profile of revolution, is divided into
    strips along x, about six elements wide. With `drive.stiffness` the indenter is held along x by a spring
    and slides with V - dx/dt, which may be negative; the default scheme remains of second order.

    Parameters
    ----------
    scene
        What is modelled; without it, the paper's Table 1 with a dead weight.
    per_length
        Elements per length, 1/dx, in 1/m or as text with a unit; without it 200 in a millimetre.
    scheme
        Time integration scheme: a name in `kvtheory.models.elements.schemes.SCHEMES`.
    at
        Output times, in s or as text with a unit; without it, about 400 over the run.
    time_step
        The longest step, in s or as text with a unit; without it 2 dx/V, as in the paper, and less
        where the scheme, or the spring, needs it (but never for the scheme ``"paper"``).
    certify
        Whether to estimate the error, by two more runs with half as many elements and steps; if not, the
        certificate is of the kind ``"none"``.
    progress
        Called as in `transient`, with the number of steps as its text.
    warn
        Called with the text of `warning`, if there is one, before the run begins.

    Returns
    -------
    Simulation
        Arrays over time in SI and a certificate. `warning` is not empty if the time step may be too long.
        With a spring, a `SprungSimulation`.

    Raises
    ------
    SceneError
        If a time, the density or the step is wrong; every mistake is listed.
    ValueError
        If the scheme does not exist, the density or the step does not suit the scene, or the foundation is a
        springpot, which has no finite state.
    DivergenceError
        If the run becomes unstable, with when, why, and which step would be stable.

    Examples
    --------
    >>> import kvtheory as kv
    >>> run = kv.elements(at=["0 ms", "1 ms", "200 ms"])
    >>> (run.normal_force / 1e3).round(2).tolist()
    [35.37, 12.73, 9.81]
    >>> rubber = kv.GeneralizedMaxwell("10 GN/m^3", arms=[["30 GN/m^3", "10 ms"]])
    >>> run = kv.elements(kv.Scene(foundation=rubber), at=["0 ms", "1 ms", "200 ms"])
    >>> (run.normal_force / 1e3).round(2).tolist()
    [9.81, 9.93, 9.81]
    >>> ball = kv.Scene(kv.Sphere("10 mm"), support=kv.DeadWeight(mass="1 kg"))
    >>> kv.elements(ball, per_length="50 /mm", at=["0 ms", "200 ms"]).normal_force.round(2).tolist()
    [49.48, 9.81]

    References
    ----------
    Nakano and Kono (2020), doi:10.3389/fmech.2020.00038, Eqs. 1-25 and Methods.
    """
    scene = one_scene(scene, "a simulation")
    # They import SciPy, which takes a while.
    from kvtheory.models.elements.schemes import SCHEMES
    from kvtheory.models.elements.simulation import simulate
    from kvtheory.models.steady.stable_sliding import ended

    try:
        with double_precision(scene):
            found = simulate(
                scene, 1.0 / (per_length or DENSITY), SCHEMES[scheme], at=times_of(scene, at),
                time_step=time_step, certify=certify, progress=progress, warn=warn,
            )  # fmt: skip
            if isinstance(found, SprungSimulation) and found.cycle is not None:
                found = replace(found, cycle=ended(scene, found.cycle))
            return noted(scene, found)
    except ValueError as error:
        key, _, hint = str(error).partition(": ")
        if per_length is not None or not key.startswith("`per_length`"):
            raise
        raise ValueError(
            f"the default density, {DENSITY / 1e3:g} elements per mm, does not suit the size of "
            f"this scene: give `per_length`, {hint}"
        ) from None
