r"""Where the work of the drive goes: the energy ledger of a transient (fact F14).

In units of W_0 delta_0, with integrals over the contact (in) and over the surface outside it (out),

    int lambda_0 f_x ds + 2/5 = 1/2 eps d'^2 - (d - 1) + 1/2 kappa (d - 1)^2
                              + 1/2 eps_x x'^2 + 1/2 kappa_x x^2 + int c_x x'^2 ds
                              + 3/8 int_in u^2 dxi + 3/8 int_out u^2 dxi
                              + 3/4 int int_in u'^2 dxi ds + 3/4 int int_out u'^2 dxi ds,

where 2/5 is stored at rest, and x = 0 for a rigid drive. No term is the remainder of the others: under
the indenter the integrals over xi are polynomials of the edges, what is stored outside is what the memory
holds, and since u' = -u there, twice that energy is dissipated per unit of time (F14-surface).
"""

from dataclasses import astuple, dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kvtheory.models.continuum import evaluation
from kvtheory.models.continuum.quadrature import integrals
from kvtheory.models.continuum.solver import Moment, Trajectory
from kvtheory.models.continuum.surface import Array, kept, relaxing


@dataclass(frozen=True)
class Ledger:
    """Energies at one time, or arrays of them: in units of W_0 delta_0, or in J/m.

    `stored_at_rest` and the `work` of the drive since then are spent on the other entries; the
    dissipated energies are sums since the start. What is potential is zero at the static depth. The last
    three are of a drive with a spring: of the motion along x, in the spring, and in the damper.
    """

    stored_at_rest: Any
    work: Any
    kinetic: Any
    potential_weight: Any
    potential_spring: Any
    stored_contact: Any
    stored_surface: Any
    dissipated_contact: Any
    dissipated_surface: Any
    kinetic_along: Any = 0.0
    stored_drive: Any = 0.0
    dissipated_drive: Any = 0.0

    @property
    def balance(self) -> Any:
        """What was given minus what it was spent on: zero, but for the error of the solution."""
        rest, work, *spent = astuple(self)
        return rest + work - sum(spent)

    def scaled(self, unit: float) -> "Ledger":
        """Return the ledger with every entry multiplied by `unit`."""
        return Ledger(*(unit * entry for entry in astuple(self)))


def ledger(motion: Trajectory, s: ArrayLike) -> Ledger:
    """Return the energy ledger at the times `s`; entries have their shape.

    Raises
    ------
    ValueError
        If a time lies outside the motion.

    Examples
    --------
    >>> from kvtheory.models.continuum.solver import solve
    >>> from kvtheory.scene.base_motion import BaseMotion
    >>> motion = solve(BaseMotion.constant(4.0, end=2.0), 0.04, 0.0, end=2.0)
    >>> books = ledger(motion, 1.0)
    >>> print(f"{books.work:.6f} {books.dissipated_contact:.6f} {books.dissipated_surface:.6f}")
    3.589813 2.722622 0.443824
    >>> bool(abs(books.balance) < 1e-9)
    True
    """
    times, memory = np.asarray(s, dtype=float), kept(motion, 2)
    flat = times.reshape(-1).tolist()
    starts = np.array([start for start in motion.starts if start <= max(flat, default=0.0)])
    index = np.searchsorted(starts, flat, side="right") - 1
    low, high = np.append(starts[:-1], starts[index]), np.append(starts[1:], flat)
    parts = integrals(lambda _, t: _powers(motion, t, memory), low, high)
    steps = starts.size - 1
    sums = np.concatenate([np.zeros((1, parts.shape[1])), np.cumsum(parts[:steps], axis=0)])
    spent = sums[index] + parts[steps:]
    free = relaxing(motion, flat, 2, memory)
    along = motion.states(flat)[:, [evaluation.ALONG, evaluation.ALONG_RATE]]
    rows = [
        _entries(motion, motion.at(t), *of) for t, *of in zip(flat, free, spent, along, strict=True)
    ]
    count = len(fields(Ledger))
    return Ledger(*np.array(rows).reshape(-1, count).T.reshape(count, *times.shape))


def _entries(
    motion: Trajectory, now: Moment, free: float, spent: Array, along: Array
) -> list[float]:
    given = motion.given
    eps, kappa = 0.0 if given.fixed else given.eps, given.kappa
    work, in_contact, in_surface, in_damper = spent.tolist()
    x, w = along.tolist()
    return [
        _stored(1.0, -1.0, 1.0),
        work,
        0.5 * eps * now.rate**2,
        1.0 - now.depth,
        0.5 * kappa * (now.depth - 1.0) ** 2,
        0.0 if now.left_state == "free" else _stored(now.depth, now.left, now.right),
        0.375 * free,
        in_contact,
        in_surface,
        0.5 * given.eps_x * w * w,
        0.5 * given.spring * x * x,
        in_damper,
    ]


def _powers(motion: Trajectory, times: Array, memory: list[tuple[float, float]]) -> Array:
    """Return the power of the drive and what is dissipated in the contact, behind it and in the damper."""
    flat = times.reshape(-1)
    found = motion.states(flat).T
    l, r, v, number = found[[evaluation.LEFT, evaluation.RIGHT, evaluation.RATE, evaluation.NUMBER]]
    thirds = 4.0 / 3.0 * number * number * (r * r + r * l + l * l)
    inside = 0.75 * (r - l) * (v * v - 2.0 * number * v * (r + l) + thirds)
    behind = 0.75 * relaxing(motion, flat.tolist(), 2, memory)
    work = found[evaluation.DRIVE] * found[evaluation.FRICTION_FORCE]
    in_damper = motion.given.damping * found[evaluation.ALONG_RATE] ** 2
    in_contact = np.where(np.isnan(l), 0.0, inside)  # in flight there are no edges
    powers = np.stack([work, in_contact, behind, in_damper], axis=-1)
    return powers.reshape(*times.shape, powers.shape[-1])


def _stored(d: float, l: float, r: float) -> float:
    """Return 3/8 int (d - xi^2)^2 dxi from `l` to `r`."""
    third, fifth = (r**3 - l**3) / 3.0, (r**5 - l**5) / 5.0
    return 0.375 * (d * d * (r - l) - 2.0 * d * third + fifth)
