"""Balances that hold in every transient: of momentum and of energy (F14).

In the contact everything is a polynomial of depth, drive and edges. Outside, each element relaxes freely, and
only two facts are needed: its rate follows from its own compression, and at an edge the surface meets the
indenter.
"""

import sympy as sp

from ..engine.book import established
from ..engine.chapter import Chapter
from ..engine.nomenclature import letter
from ..engine.step import Proof
from .model import C, F_z, K, t, tau
from .power_law_weight import a_0
from .tables import delta_0
from .theorems import kappa, lam
from .transient_edges import left, right
from .transient_memory import OF_TIME, SECTION, compression, depth, material, time, travel
from .transient_motion import CONTACT, f_friction
from .transient_scaling import W_0, P, d, d_s, d_ss, eps, f_normal, xi

letter("U", "integral of the compression over all elements", "m²")
letter(r"\bar U", r"scaled integral of the compression, $U/(a_0 \delta_0)$")
letter(r"E_{\mathrm{s}}", "energy of the surface outside the contact")

_ends = sp.symbols("X_1 X_2", real=True)
"""A stretch of the foundation outside of which no element was ever pressed."""
_left, _right = (sp.Function(name, real=True)(time) for name in ("ell", "r"))
_IN_TIME = {**OF_TIME, lam: sp.Derivative(travel, time), left: _left, right: _right}

_u = compression(material, time)
_u_s = sp.Derivative(_u, time)
_share = sp.Rational(3, 4)
_speed = sp.Derivative(depth, time)
_height, _rate = d - xi**2, d_s - 2 * lam * xi
"""Compression under the indenter, and its rate in the foundation."""
_total, _free = (sp.Function(name, real=True) for name in "SE")
"""The compression of all elements (it prints as U with a bar); the energy of those outside."""
result = Chapter(SECTION)


def _outside(density: sp.Expr) -> sp.Expr:
    """Integrate over the elements on both sides of the contact."""
    first, last = _ends
    return sp.Integral(density, (material, first, _left - travel)) + sp.Integral(
        density, (material, _right - travel, last)
    )


def _relaxing(proof: Proof) -> None:
    """Define the known properties of the surface outside the contact."""
    proof.define(_u_s, -_u, "outside there is no pressure, Eq. (20)")
    for edge in (_left, _right):
        proof.define(
            *(compression(edge - travel, time), depth - edge**2, "there the surface meets the indenter"),
        )  # fmt: skip


@result("F14-surface")
def _surface(proof: Proof) -> None:
    """Energy of the surface that relaxes.

    Outside the contact each element relaxes freely; beyond $X_1$ and $X_2$ none was ever compressed. The
    energy that leaves the contact at its edges is stored in the free surface as $E$ and dissipated there at
    the rate $2 E$.
    """
    energy = _free(time)
    handed = [
        (depth - edge**2) ** 2 * sp.Derivative(edge - travel, time) for edge in (_left, _right)
    ]
    change = -2 * energy + _share / 2 * (handed[0] - handed[1])
    _relaxing(proof)
    proof.define(energy, _share / 2 * _outside(_u**2), "the springs on both sides")
    proof.equal(_share * _outside(_u_s**2), 2 * energy, "the dampers there")
    reason = "the ends of the integrals move with the edges"
    proof.equal(sp.Derivative(energy, time), change, reason)


@result("F14-force")
def _force(proof: Proof) -> None:
    """Normal force from the compression of all elements.

    $S$ is the compression of all elements, including those that relax outside the contact. Sliding in the
    other direction is the mirror image, here and in the balance of energy.
    """
    total = _total(time)
    force = _share * (total + sp.Derivative(total, time))
    _relaxing(proof)
    _let_move(proof)
    inside = (_right - _left) * depth - (_right**3 - _left**3) / 3
    under = _under(proof, _height.subs(_IN_TIME), "under the indenter", inside)
    proof.define(total, _outside(_u) + under, "all elements")
    proof.recall("F11")
    proof.equal(f_normal, force, _CONTINUOUS)


_CONTINUOUS = "the terms from moving ends cancel: the surface is continuous at the edges"


def _let_move(proof: Proof) -> None:
    """Let depth, drive and edges be functions of time."""
    for name, value in _IN_TIME.items():
        proof.define(name, value)


def _obey(proof: Proof) -> None:
    """Let the indenter obey its equation of motion."""
    proof.define(sp.Derivative(depth, (time, 2)), d_ss)
    proof.recall("scaled-form")


@result("F14")
def _momentum(proof: Proof) -> None:
    """Balance of momentum.

    With $S$ of F14-force, in dimensional form $U$, the integral of the compression over all elements.
    """
    total, now = _total(time), sp.Function("U", real=True)(t)
    proof.define(d, depth)
    proof.recall("F14-force")
    _obey(proof)
    proof.equal(sp.Derivative(eps * _speed + _share * total, time),
                1 - kappa * (depth - 1) - _share * total,
                "integrated over time, the balance of impulse")  # fmt: skip
    proof.recall("scaled-pressure", W_0)
    proof.define(F_z, W_0 * f_normal)
    proof.define(C, K * tau, "Eq. (22)")
    proof.define(now, a_0 * delta_0 * _total(t / tau))
    proof.define(time, t / tau)
    result = K * now + C * sp.Derivative(now, t)
    proof.equal(F_z, result, r"in units of $W_0 = \frac{4}{3} K a_0 \delta_0$")


@result("F14-power")
def _power(proof: Proof) -> None:
    r"""Power given to the foundation.

    In units of $W_0 \delta_0/\tau$: by the motion of the indenter, and by the drive. Outside the contact
    there is no pressure, and no power.
    """
    density = _share * P * _rate
    proof.recall("scaled-pressure", "F11", "F11", f_friction)
    proof.equal(P, _height + _rate, r"$u + u'$ in the contact")
    whole = sp.Integral(density, CONTACT)
    proof.integral(whole, density, CONTACT, _POWER, value=d_s * f_normal + lam * f_friction)


_POWER = "pressure times velocity"


@result("F14-energy")
def _energy(proof: Proof) -> None:
    r"""Balance of energy.

    In units of $W_0 \delta_0$ and $W_0 \delta_0/\tau$. The power of the drive, in dimensional form $F_x V$,
    becomes kinetic energy $\frac{1}{2} M \dot\delta^2$, potential energies $-M g \delta$ and $\frac{1}{2} k_s
    (\delta - \delta_0)^2$, and energy of the springs of the foundation under the indenter and outside, $E$;
    the rest is lost in its dampers, under the indenter and outside. A fixed indenter has $d' = 0$, and only
    the foundation is left.
    """
    _let_move(proof)
    height, rate = (each.subs(_IN_TIME) for each in (_height, _rate))
    first, second, third, fifth = (_right**n - _left**n for n in (1, 2, 3, 5))
    half, drive = _share / 2, _IN_TIME[lam]
    kept = half * depth**2 * first - depth * third / 4 + half * fifth / 5
    spent = _share * _speed**2 * first - 2 * _share * drive * _speed * second + drive**2 * third
    stored = _under(proof, half * height**2, "stored under the indenter", kept)
    lost = _under(proof, _share * rate**2, "dissipated there", spent)
    proof.recall("F11", "F11", f_friction)
    energy, free = _free(time), established("F14-surface", _free(time).diff(time))
    given = _speed * f_normal + lam * f_friction - (free + 2 * energy)
    reason = "elements enter and leave at the edges"
    proof.equal(sp.Derivative(stored, time) + lost, given, reason)
    proof.recall("F14-surface")
    _obey(proof)
    moving = eps * _speed**2 / 2 - depth + kappa * (depth - 1) ** 2 / 2
    proof.equal(sp.Derivative(moving, time), -_speed * f_normal, "mass, weight and spring")
    balance = sp.Derivative(moving + energy, time) + sp.Derivative(stored, time) + lost + 2 * energy
    proof.equal(lam * f_friction, balance, "the sum of the three contributions")


def _under(proof: Proof, density: sp.Expr, reason: str, value: sp.Expr) -> sp.Expr:
    """Prove what an integral over the contact is, and return it."""
    place = (xi, _left, _right)
    whole = sp.Integral(density, place)
    proof.integral(whole, density, place, reason, value=value)
    return whole
