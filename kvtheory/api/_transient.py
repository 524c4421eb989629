"""The whole transient: `transient`."""

from dataclasses import replace
from functools import partial
from typing import Any

from kvtheory.api._edge import double_precision, noted, one_scene, times_of
from kvtheory.progress import Progress
from kvtheory.results import SprungTransient, Transient
from kvtheory.scene.arguments import a_scene, callback, checked, count, flag, number, times
from kvtheory.scene.capabilities import lacks_continuum, require
from kvtheory.scene.model import Scene

MINIMUM_RTOL, MAXIMUM_RTOL = 1e-12, 1e-2
"""Beyond these, rounding or the first step would dominate."""


@checked(
    scene=a_scene, at=times, rtol=number(MINIMUM_RTOL, MAXIMUM_RTOL), certify=flag, max_steps=count,
    progress=callback,
)  # fmt: skip
def transient(
    scene: Scene | None = None,
    *,
    at: Any = None,
    rtol: float = 1e-6,
    certify: bool = True,
    max_steps: int | None = None,
    progress: Progress | None = None,
) -> Transient:
    """Compute the transient of a scene without discretizing the foundation.

    It solves M z_A'' = F_z - M g (Eq. 17), with the spring of a suspended indenter, where F_z = int p dx and
    p = K u + C du/dt in the contact; a fixed indenter keeps its depth.

    Parameters
    ----------
    scene
        What is modelled; without it, the paper's Table 1 with a dead weight. The indenter must be a parabola
        (`elements` simulates any shape). At t < 0 it rests at its static depth. With `drive.stiffness` it is
        held along x by a spring that is then relaxed; the mass that moves along x must be above zero. A drive
        that is a function of time is replaced by polynomials within its tolerance, which the certificate adds
        to the errors of the velocities, the pressure and the surface, but not of the other quantities.
    at
        Output times, in s or as text with a unit, such as ``"0 ms, 1 ms"`` or ``"0 ms:200 ms:201"``
        (START:STOP:COUNT, both ends included); without it, the steps of the solver, subdivided.
    rtol
        Error allowed in a step, relative to the static state, from 1e-12 to 1e-2.
    certify
        Whether to estimate the error, by a second run with a tighter tolerance; if not, the errors in the
        certificate are infinite.
    max_steps
        Steps after which to give up; by default 300,000 plus 100 for each piece of the drive, on a Prony
        series 30,000.
    progress
        Called repeatedly with the share of the work done, from 0 to 1, and a text, as by every public
        function: `kvtheory.progress.progress_bar` provides one that shows both.

    Returns
    -------
    Transient
        Arrays over time in SI, the events of the contact, and a certificate whose errors are relative to the
        static depth, half length and load. With a spring, a `SprungTransient`.

    Raises
    ------
    SceneError
        If a time is wrong; every mistake is listed.
    ValueError
        If the indenter is not a parabola, if the contact on a Prony series parts, if an argument is out of
        range, or a function that drives the foundation fails, is not finite, or is not smooth between its
        breaks.
    ArithmeticError
        If the motion cannot be computed to its end; the message says when and why.

    Examples
    --------
    >>> import kvtheory as kv
    >>> result = kv.transient(at=["0 ms", "1 ms", "200 ms"])
    >>> (result.normal_force / 1e3).round(2).tolist()
    [35.37, 12.73, 9.81]
    >>> (result.friction_force / 1e3).round(2).tolist()
    [5.35, 2.35, 0.84]

    References
    ----------
    Nakano and Kono (2020), doi:10.3389/fmech.2020.00038, Eqs. 1-33 and Figs. 3, 4.
    """
    scene = one_scene(scene, "a transient")
    require(lacks_continuum, scene, "the transient")
    with double_precision(scene):
        from kvtheory.models.continuum import solved_scene
        from kvtheory.models.steady import stable_sliding

        found = solved_scene.transient(
            scene, times_of(scene, at), rtol, progress, certify=certify, max_steps=max_steps
        )
        if isinstance(found, SprungTransient):
            found = replace(found, ended=partial(stable_sliding.ended, scene))
        return noted(scene, found)
