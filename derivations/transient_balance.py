"""Balances that hold in every transient: of momentum and of energy (F14)."""

from functools import partial

import sympy as sp

from .record import Derivation
from .step import Proof
from .symbols import (
    compression,
    d,
    d_s,
    depth,
    eps,
    f_friction,
    f_normal,
    kappa,
    lam,
    left,
    material,
    right,
    time,
    travel,
    xi,
)  # fmt: skip
from .transient_memory import OF_TIME, SECTION
from .transient_motion import CONTACT, FRICTION_FORCE, NORMAL_FORCE
from .transient_scaling import PRESSURE

_first, _last = sp.symbols("X_1 X_2", real=True)
ELEMENTS = (material, _first, _last)
"""A stretch of the foundation outside of which every element is at rest."""

_u = compression(material, time)
_u_s = sp.Derivative(_u, time)
_share = sp.Rational(3, 4)
_speed = sp.Derivative(depth, time)
_theorem = partial(Proof, equation=None, section=SECTION)


def derive() -> tuple[Derivation, ...]:
    """Prove F14."""
    return _momentum(), _power(), _energy(), _surface()


def _momentum() -> Derivation:
    proof = _theorem("F14", title="Balance of momentum", text=_MOMENTUM, uses=("F8", "scaled-form"))
    total = sp.Integral(_u, ELEMENTS)
    proof.notation |= {r"\int": sp.Tuple(*ELEMENTS), "U": sp.Lambda(time, total), "u": _u}
    force = _share * (total + sp.Derivative(total, time))
    pushed = _share * sp.Integral(_u + _u_s, ELEMENTS)
    proof.define(f_normal, pushed, r"$\hat p$ is zero outside the contact",
                 right=r"\frac{3}{4} \int \left(u + u'\right) dX")  # fmt: skip
    proof.equal(
        f_normal, force, "summed over all elements", right=r"\frac{3}{4} \left(U + U'\right)"
    )
    proof.define(
        *(sp.Derivative(depth, (time, 2)), (1 - f_normal - kappa * (depth - 1)) / eps, "scaled motion"),
        left="d''", right=r"\frac{1 - f_z - \kappa (d - 1)}{\varepsilon}",
    )  # fmt: skip
    change = sp.Derivative(eps * _speed + _share * total, time)
    impulse = 1 - kappa * (depth - 1) - _share * total
    proof.equal(
        *(change, impulse, "integrated over time, the balance of impulse"),
        left=r"\frac{d}{ds} \left[\varepsilon d' + \frac{3}{4} U\right]",
        right=r"1 - \kappa (d - 1) - \frac{3}{4} U",
    )
    return proof.done(f_normal, force)


_MOMENTUM = (
    r"With $U = \int u \, dX$ over all elements, also those that relax outside the contact. In "
    r"dimensional form, $F_z = K U + C \dot U$ with $U = \int u \, dx$."
)


def _power() -> Derivation:
    proof = _theorem("F14-power", title="Power given to the foundation", text=_POWER,
                     uses=("scaled-pressure",))  # fmt: skip
    rate = d_s - 2 * lam * xi
    density = sp.expand(_share * PRESSURE * rate)
    proof.recall("F11", f_normal, NORMAL_FORCE)
    proof.recall("F11", f_friction, FRICTION_FORCE)
    proof.notation |= {r"\hat p": PRESSURE, "u'": rate}
    proof.equal(PRESSURE, d - xi**2 + rate, r"$u + u'$ in the contact", left=r"\hat p")
    whole = sp.Integral(density, CONTACT)
    proof.integral(
        *(whole, density, CONTACT, sp.integrate(density, xi), "pressure times velocity"),
        left=r"\frac{3}{4} \int_{\ell}^{r} \hat p u' \, d\xi", right=r"d' f_z + \lambda f_x",
        value=d_s * f_normal + lam * f_friction,
    )  # fmt: skip
    return proof.done(whole, d_s * f_normal + lam * f_friction)


_POWER = r"In units of $W_0 \delta_0/\tau$: by the motion of the indenter, and by the drive."


def _energy() -> Derivation:
    proof = _theorem(
        "F14-energy", title="Balance of energy", text=_ENERGY, uses=("scaled-form", "F14-power")
    )
    stored = _share * sp.Integral(_u**2 / 2, ELEMENTS)
    lost = _share * sp.Integral(_u_s**2, ELEMENTS)
    given = _share * sp.Integral((_u + _u_s) * _u_s, ELEMENTS)
    moving = eps * _speed**2 / 2 - depth + kappa * (depth - 1) ** 2 / 2
    proof.notation |= {r"\int": sp.Tuple(*ELEMENTS), "u": _u, r"\hat p": _u + _u_s}
    proof.define(
        *(sp.Derivative(depth, (time, 2)), (1 - f_normal - kappa * (depth - 1)) / eps, "scaled motion"),
        left="d''", right=r"\frac{1 - f_z - \kappa (d - 1)}{\varepsilon}",
    )  # fmt: skip
    proof.equal(
        *(sp.Derivative(moving, time), -_speed * f_normal, "kinetic energy, weight and spring"),
        left=rf"\frac{{d}}{{ds}} \left[{_MOVING}\right]", right="-d' f_z",
    )  # fmt: skip
    proof.equal(
        *(given, sp.Derivative(stored, time) + lost, "springs and dampers, outside the contact as well"),
        left=r"\frac{3}{4} \int \hat p u' \, dX", right=rf"\frac{{d}}{{ds}} {_STORED} + {_LOST}",
    )  # fmt: skip
    proof.define(
        *(lam * f_friction, given - _speed * f_normal, "F14-power, with no pressure outside"),
        left=_DRIVE,
        right=r"\frac{3}{4} \int \hat p u' \, dX - d' f_z",
    )
    balance = sp.Derivative(moving + stored, time) + lost
    proof.equal(
        *(lam * f_friction, balance, "what it is spent on"),
        left=_DRIVE,
        right=rf"\frac{{d}}{{ds}} \left[{_MOVING} + {_STORED}\right] + {_LOST}",
    )
    return proof.done(lam * f_friction, balance)


_DRIVE = r"\lambda f_x"
_MOVING = r"\frac{\varepsilon d'^2}{2} - d + \frac{\kappa}{2} (d - 1)^2"
_STORED = r"\frac{3}{8} \int u^2 \, dX"
_LOST = r"\frac{3}{4} \int u'^2 \, dX"
_ENERGY = (
    r"In units of $W_0 \delta_0$ and $W_0 \delta_0/\tau$, with integrals over all elements. In dimensional "
    r"form the power $F_x V$ of the drive is the rate of change of the kinetic energy $\frac{1}{2} M "
    r"\dot\delta^2$, of the potential energies $-M g \delta$ and $\frac{1}{2} k_s (\delta - \delta_0)^2$ and "
    r"of the energy $\int \frac{1}{2} K u^2 dx$ of the springs, and the power $\int C \dot u^2 dx$ lost in "
    "the dampers. A fixed indenter has $d' = 0$, and only the foundation is left."
)


def _surface() -> Derivation:
    proof = _theorem("F14-surface", title="Energy of the surface that relaxes", text=_HANDED_OVER,
                     uses=("F8", "F14-energy"))  # fmt: skip
    height, rate = d - xi**2, d_s - 2 * lam * xi
    stored, lost, exchange = (
        sp.integrate(sp.expand(share * density), CONTACT)
        for share, density in (
            (_share / 2, height**2), (_share, rate**2), (_share, height * rate),
        )
    )  # fmt: skip
    for share, density, value, shown in (
        (_share / 2, height**2, stored, "stored under the indenter"),
        (_share, rate**2, lost, "dissipated there"),
    ):
        integrand = sp.expand(share * density)
        whole = sp.Integral(integrand, CONTACT)
        proof.integral(whole, integrand, CONTACT, sp.integrate(integrand, xi), shown, value=value)
    moving = {**OF_TIME, lam: sp.Derivative(travel, time)}
    moving |= {end: sp.Function(str(end), real=True)(time) for end in (left, right)}
    at_right, at_left = (
        _share / 2 * height.subs(xi, end) ** 2 * (sp.Derivative(moving[end], time) - lam)
        for end in (right, left)
    )
    change = sp.Derivative(stored.subs(moving), time)
    free = {name: sp.Lambda(xi, each.subs(moving)) for name, each in (("u", height), ("u'", rate))}
    proof.notation |= {r"\ell": moving[left], "r": moving[right], "d": depth, **free}
    proof.notation[r"\lambda"] = moving[lam]
    parts = (exchange + at_right - at_left).subs(moving)
    proof.equal(
        *(change, parts, "elements enter and leave at the edges"),
        left=r"\frac{d}{ds} \frac{3}{8} \int_{\ell}^{r} u^2 \, d\xi",
        right=r"\frac{3}{4} \int_{\ell}^{r} u u' \, d\xi + \frac{3}{8} \left[u(r)^2 (r' - \lambda) - "
        r"u(\ell)^2 (\ell' - \lambda)\right]",
    )
    proof.notation |= {"u": _u, "u'": _u_s}
    proof.define(_u_s, -_u, "outside there is no pressure", left="u'", right="-u")
    loss = -2 * (_share / 2 * _u**2)
    proof.equal(sp.Derivative(_share / 2 * _u**2, time), loss, "twice what is stored, per $\\tau$",
                left=r"\frac{d}{ds} \frac{3}{8} u^2", right=r"-2 \cdot \frac{3}{8} u^2")  # fmt: skip
    proof.equal(_share * _u_s**2, -loss, "all of it dissipated", left=r"\frac{3}{4} u'^2",
                right=r"2 \cdot \frac{3}{8} u^2")  # fmt: skip
    return proof.done(change, parts)


_HANDED_OVER = (
    r"The terms of F14-energy under the indenter are polynomials of the edges. What the contact hands "
    r"over at its edges is stored in the free surface, $E = \frac{3}{8} \int u^2 \, d\xi$ outside, and "
    r"dissipated there at the rate $2 E$, so that $E' = -2 E + \frac{3}{8} [u^2(\ell) (\ell' - \lambda) - "
    r"u^2(r) (r' - \lambda)]$."
)
