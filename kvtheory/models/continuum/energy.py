r"""Where the work of the drive goes: the energy ledger of a transient (fact F14).

In units of W_0 delta_0, with integrals over the contact (in) and over the surface outside it (out),

    int lambda_0 f_x ds + E_0 = 1/2 eps d'^2 - (d - 1) + 1/2 kappa (d - 1)^2
                              + 1/2 eps_x x'^2 + 1/2 kappa_x x^2 + int c_x x'^2 ds
                              + 3/8 int_in u^2 dxi + 3/8 int_out u^2 dxi
                              + 3/4 int int_in u'^2 dxi ds + 3/4 int int_out u'^2 dxi ds,

where E_0 is the right side at s = 0: 2/5 at rest; x = 0 for a rigid drive. No term is the remainder of the
others: under the indenter the integrals over xi are polynomials of the edges, the energy stored outside
follows from the memory, and since u' = -u there, twice that energy is dissipated per unit of time
(F14-surface).
"""

from collections.abc import Callable
from dataclasses import astuple, dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kvtheory.models.continuum.surface import Array, integrals, kept, relaxing


@dataclass(frozen=True)
class Ledger:
    """Energies at one time, or arrays of them: in units of W_0 delta_0, or in J/m.

    What the foundation `stored_at_rest`, what the indenter had at the start, kinetic and potential
    (`of_start`), and the `work` of the drive since then are spent on the other entries; the
    dissipated energies are sums since the start. Potential energies are zero at the static depth. Three
    are for a drive with a spring: kinetic along x, stored in the spring, dissipated in the damper.
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
    of_start: Any = 0.0

    @property
    def balance(self) -> Any:
        """Energy given less energy spent: zero, but for the error of the solution."""
        rest, work, *spent, start = astuple(self)
        return rest + start + work - sum(spent)

    def scaled(self, unit: float) -> "Ledger":
        """Return the ledger with every entry multiplied by `unit`."""
        return Ledger(*(unit * entry for entry in astuple(self)))


@dataclass(frozen=True)
class Impulses:
    """Downward impulses on the indenter until one time, or arrays of them: in units of W_0 tau, or in N s/m.

    Its momentum at the start (`of_start`), and the impulses of its weight, of the spring of its support and
    of the foundation since then, make its present `momentum`.
    """

    of_start: Any
    of_weight: Any
    of_spring: Any
    of_foundation: Any
    momentum: Any

    @property
    def balance(self) -> Any:
        """Impulses given less the momentum: zero, but for the error of the solution."""
        *given, momentum = astuple(self)
        return sum(given) - momentum

    def scaled(self, unit: float) -> "Impulses":
        """Return the impulses multiplied by `unit`."""
        return Impulses(*(unit * entry for entry in astuple(self)))


MOVING = "depth", "depth_rate", "offset", "offset_rate"
"""What of a state has energy itself."""


def ledger(motion: Any, s: ArrayLike) -> Ledger:
    """Return the energy ledger at the times `s`, in their shape.

    >>> from kvtheory.models.continuum.solver import solve
    >>> from kvtheory.scene.base_motion import BaseMotion
    >>> books = ledger(solve(BaseMotion.constant(4.0, end=2.0), 0.04, 0.0, end=2.0), 1.0)
    >>> print(f"{books.work:.6f} {books.dissipated_contact:.6f} {abs(books.balance) < 1e-9}")
    3.589813 2.722622 True
    """
    times, memory, given = np.asarray(s, dtype=float), kept(motion, 2), motion.given
    flat = times.reshape(-1)

    def powers(_: Any, t: Array) -> Array:
        """Return the power of the drive, and those dissipated in contact, behind it and in the damper."""
        found = motion.states(t.reshape(-1))
        (l, r), v, number = found["edges"].T, found["depth_rate"], found["sliding_velocity"]
        thirds = 4.0 / 3.0 * number * number * (r * r + r * l + l * l)
        inside = 0.75 * (r - l) * (v * v - 2.0 * number * v * (r + l) + thirds)
        inside = np.where(np.isnan(l), 0.0, inside)  # in flight there are no edges
        behind = 0.75 * relaxing(motion, t.reshape(-1).tolist(), 2, memory)
        work, damped = (
            found["velocity"] * found["friction_force"],
            given.damping * found["offset_rate"] ** 2,
        )
        if given.fixed:  # what holds the indenter moves it
            work = work + v * found["normal_force"]
        rows = work, inside, behind, damped
        return np.stack(rows, axis=-1).reshape(*t.shape, len(rows))

    sums = accumulated(lambda low, high: integrals(powers, low, high), motion.starts, flat)
    found = motion.states(flat)
    d, (l, r) = found["depth"], found["edges"].T
    inside = np.where(np.isnan(l), 0.0, _stored(d, l, r))
    stored = inside, 0.375 * relaxing(motion, flat.tolist(), 2, memory)
    moving = np.array([found[name] for name in MOVING])
    return entries(given, moving, sums, stored, times.shape)


def impulses(motion: Any, states: Callable[[Array], Any], s: ArrayLike) -> Impulses:
    """Return the impulses at the times `s`, in their shape; `states` returns those of the motion at times.

    eps d' = eps d'_0 + int 1 - kappa (d - 1) - f_z ds.
    """
    given = motion.given
    if given.fixed:
        raise ValueError("a fixed indenter has no momentum: what holds it takes every impulse")
    times = np.asarray(s, dtype=float)
    flat = times.reshape(-1)

    def forces(_: Any, t: Array) -> Array:
        found = states(t.reshape(-1))
        both = found["normal_force"], found["depth"] - 1.0
        return np.stack(both, axis=-1).reshape(*t.shape, 2)

    lift, sunk = accumulated(lambda low, high: integrals(forces, low, high), motion.natural, flat)
    begun = np.full(flat.shape, given.eps * given.start_rate)
    found = begun, flat, -given.kappa * sunk, -lift, given.eps * states(flat)["depth_rate"]
    return Impulses(*(entry.reshape(times.shape)[()] for entry in found))


def accumulated(integrated: Callable[[Array, Array], Array], starts: ArrayLike, s: Array) -> Array:
    """Return the energies since the start at the times `s`: a row for each power.

    `integrated` returns those between two arrays of times, a column for each power; `starts` are those of
    the steps.
    """
    starts = np.array([start for start in np.asarray(starts) if start <= max(s, default=0.0)])
    index = np.searchsorted(starts, s, side="right") - 1
    parts = integrated(np.append(starts[:-1], starts[index]), np.append(starts[1:], s))
    steps = starts.size - 1
    sums = np.concatenate([np.zeros((1, parts.shape[1])), np.cumsum(parts[:steps], axis=0)])
    return np.asarray((sums[index] + parts[steps:]).T)


def entries(given: Any, moving: Array, sums: Array, stored: Any, shape: tuple[int, ...]) -> Ledger:
    """Return the ledger: of d, d', x, x'; of work and dissipated energies; of what the foundation stores."""
    d, v, x, w = moving
    work, in_contact, in_surface, in_damper = sums
    eps, half_length = 0.0 if given.fixed else given.eps, np.sqrt(max(given.start_depth, 0.0))
    d_0, v_0, w_0 = given.start_depth, given.start_rate, given.start_along

    def full(value: float) -> Array:
        return np.full(d.shape, value)

    weight = 0.0 if given.fixed else 1.0
    of_start = weight * (1.0 - d_0) + 0.5 * (eps * v_0**2 + given.kappa * (d_0 - 1.0) ** 2)
    found = (
        full(_stored(d_0, -half_length, half_length)), work, 0.5 * eps * v**2,
        weight * (1.0 - d), 0.5 * given.kappa * (d - 1.0) ** 2, *stored, in_contact, in_surface,
        0.5 * given.eps_x * w * w, 0.5 * given.spring * x * x, in_damper,
        full(of_start + 0.5 * given.eps_x * w_0**2),
    )  # fmt: skip
    return Ledger(*(entry.reshape(shape)[()] for entry in found))


def _stored(d: Any, l: Any, r: Any) -> Any:
    """Return 3/8 int (d - xi^2)^2 dxi from `l` to `r`."""
    third, fifth = (r**3 - l**3) / 3.0, (r**5 - l**5) / 5.0
    return 0.375 * (d * d * (r - l) - 2.0 * d * third + fifth)
