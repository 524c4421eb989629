"""The model: Eqs. 1-25, from the shape of the indenter to the free elements behind it."""

from functools import partial

import sympy as sp

from .book import Shown
from .record import Derivation
from .step import Proof
from .symbols import (
    C,
    F_x,
    F_z,
    K,
    M,
    N,
    R,
    V,
    c,
    delta,
    delta_t,
    f_c,
    f_n,
    f_x,
    f_z,
    g,
    h,
    k,
    t,
    t_0,
    tau,
    theta,
    u_i,
    x,
    x_i,
    z,
    z_a,
)  # fmt: skip

SECTION = "Model"

slope = h(x_i).diff(x_i)
"""h'(x_i)."""
compression_rate, depth_rate = u_i.diff(t), delta_t.diff(t)

_RATE, _SLOPE = r"\dot{u}_i", "h'(x_i)"
_equation = partial(Proof, section=SECTION)


def derive() -> tuple[Derivation, ...]:
    """Derive Eqs. 1-25, in the order of their numbers."""
    found = [*_surface(), *_kinematics(), *_forces(), *_indenter(), *_retardation(), *_separation()]
    return tuple(sorted(found, key=lambda derivation: derivation.equation or 0))


def _surface() -> list[Derivation]:
    fixed = _equation("eq1", 1, title="Surface of the fixed indenter")
    fixed.define(z(x), h(x) - delta, "the depth is constant", right=r"h(x) - \delta")
    moving = _equation("eq2", 2, title="Surface of the movable indenter")
    moving.define(z(x), h(x) - delta_t, "the depth varies", right=r"h(x) - \delta(t)")
    shape = _equation("eq3", 3, title="Shape of the indenter")
    shape.define(h(x), x**2 / (2 * R), "a cylinder of radius $R$, small slopes", left="h(x)")
    return [
        fixed.done(z(x), h(x) - delta),
        moving.done(z(x), h(x) - delta_t),
        shape.done(h(x), x**2 / (2 * R)),
    ]


def _kinematics() -> list[Derivation]:
    """Derive compression and compression rate, for the fixed and for the movable indenter."""
    found = []
    cases = (
        ("fixed", delta, r"\delta", "eq1", 4),
        ("movable", delta_t, r"\delta(t)", "eq2", 6),
    )
    for kind, depth, depth_tex, surface, number in cases:
        compression = -h(x_i) + depth
        shown: Shown = {"left": "u_i(t)", "right": f"-h(x_i) + {depth_tex}"}
        pressed = _equation(f"eq{number}", number, title=f"Compression under the {kind} indenter")
        pressed.recall(surface, z(x), h(x) - depth, "where the element is", at={x: x_i})
        pressed.define(u_i, -z(x_i), "the free surface of the foundation is $z = 0$")
        pressed.equal(u_i, compression, "the surface of the indenter", **shown)
        found.append(pressed.done(u_i, compression))

        rate = _equation(f"eq{number + 1}", number + 1, title=f"Compression rate, {kind} indenter")
        rate.recall(f"eq{number}", u_i, compression)
        rate.define(x_i.diff(t), V, "the base carries the element", left=r"\dot{x}_i(t)", right="V")
        result = -slope * V + depth.diff(t)
        rate_tex = f"-{_SLOPE} V" + (r" + \dot{\delta}(t)" if depth is delta_t else "")
        rate.equal(compression_rate, result, "chain rule", left=f"{_RATE}(t)", right=rate_tex)
        found.append(rate.done(compression_rate, result))
    return found


def _forces() -> list[Derivation]:
    force = k * u_i + c * compression_rate
    force_tex = rf"k u_i + c {_RATE}"
    vertical = _equation("eq8", 8, title="Vertical balance of an element")
    vertical.define(
        force, f_n * sp.cos(theta), "no mass at its tip, no force from neighbours", left=force_tex
    )
    across = _equation("eq9", 9, title="Horizontal balance of an element")
    across.define(f_c, f_n * sp.sin(theta), "the tip of the element has no mass")
    angle = _equation("eq10", 10, title="Inclination of the surface", text=_ANGLE)
    angle.define(sp.tan(theta), -slope, left=r"\tan\theta_i", right=f"-{_SLOPE}")
    angle.where(sp.cos(theta) > 0, "the surface is not vertical")
    angle.equal(slope, -sp.tan(theta), "the same", left=_SLOPE)
    found = [
        vertical.done(force, f_n * sp.cos(theta)),
        across.done(f_c, f_n * sp.sin(theta)),
        angle.done(sp.tan(theta), -slope),
    ]
    normal = _equation("eq11", 11, title="Normal force on an element")
    normal.recall("eq8", force, f_n * sp.cos(theta))
    normal.where(sp.cos(theta) > 0, "the surface is not vertical")
    normal.equal(
        f_n,
        force / sp.cos(theta),
        r"divide by $\cos\theta_i > 0$",
        right=rf"\frac{{{force_tex}}}{{\cos\theta_i}}",
    )
    up = _equation("eq12", 12, title="Vertical force on the indenter")
    up.recall("eq8", force, f_n * sp.cos(theta))
    up.define(f_z, f_n * sp.cos(theta), "the reaction has this vertical component")
    up.equal(f_z, force, "the same product", right=force_tex)
    found += [normal.done(f_n, force / sp.cos(theta)), up.done(f_z, force)]

    along = _equation("eq13", 13, title="Horizontal force on the indenter")
    along.recall("eq10", slope, -sp.tan(theta))
    along.define(f_x, f_n * sp.sin(theta), "the reaction has this horizontal component")
    along.define(f_z, f_n * sp.cos(theta), "and this vertical one")
    along.recall("eq9", f_c, f_n * sp.sin(theta))
    along.equal(f_c, f_x, "the constraint force is the horizontal force")
    along.equal(
        f_x,
        -slope * f_z,
        r"$\sin\theta_i = \tan\theta_i \cos\theta_i$",
        right=f"-{_SLOPE} f_{{zi}}",
    )
    return [*found, along.done(f_x, -slope * f_z)]


_ANGLE = r"The inclination is within $-\pi/2 < \theta_i < \pi/2$, so $\cos\theta_i > 0$."


def _indenter() -> list[Derivation]:
    found = []
    i = sp.Symbol("i", integer=True)
    sums = ((14, F_z, "f_z", "vertical"), (15, F_x, "f_x", "horizontal"))
    for number, total, name, direction in sums:
        whole = sp.Sum(sp.IndexedBase(name)[i], (i, 1, sp.oo))
        force = _equation(f"eq{number}", number, title=f"Total {direction} force")
        force.define(total, whole, "all elements act on the indenter")
        found.append(force.done(total, whole))

    held = _equation("eq16", 16, title="Position of the fixed indenter")
    held.define(
        z_a, -delta, "the lowest point A stays at the depth $\\delta$", left=r"z_{\mathrm{A}}"
    )
    motion = _equation("eq17", 17, title="Motion of the movable indenter")
    inertia = M * z_a.diff(t, 2)
    motion.define(inertia, F_z - M * g, "Newton's law", left=r"M \ddot{z}_{\mathrm{A}}")
    found += [held.done(z_a, -delta), motion.done(inertia, F_z - M * g)]

    depth = _equation("eq18", 18, title="Depth of the movable indenter")
    lowest = {x: sp.S.Zero}
    depth.recall("eq2", z(x), h(x) - delta_t, "the lowest point A", at=lowest)
    depth.recall("eq3", h(x), x**2 / (2 * R), at=lowest)
    depth.define(z_a, z(0), "its height", left=r"z_{\mathrm{A}}(t)")
    depth.equal(delta_t, -z_a, "$h(0) = 0$", left=r"\delta(t)", right=r"-z_{\mathrm{A}}(t)")
    found.append(depth.done(delta_t, -z_a))

    rate = _equation("eq19", 19, title="Rate of the depth")
    rate.recall("eq18", delta_t, -z_a)
    sides: Shown = {"left": r"\dot{\delta}(t)", "right": r"-\dot{z}_{\mathrm{A}}(t)"}
    rate.equal(depth_rate, -z_a.diff(t), "derivative with respect to time", **sides)
    return [*found, rate.done(depth_rate, -z_a.diff(t))]


def _retardation() -> list[Derivation]:
    micro = _equation("eq21", 21, title="Retardation time of an element")
    micro.define(tau, c / k)
    macro = _equation("eq22", 22, title="Retardation time of the foundation")
    found = [micro.done(tau, c / k)]
    macro.recall("eq21", tau, c / k)
    macro.define(k, K / N, "there are $N$ elements per unit length")
    macro.define(c, C / N, "likewise")
    macro.equal(tau, C / K, "$N$ cancels")
    found.append(macro.done(tau, C / K))

    free = _equation("eq20", 20, title="Relaxation of a free element")
    force = k * u_i + c * compression_rate
    free.recall("eq12", f_z, force)
    free.recall("eq21", tau, c / k)
    reason = "without contact $f_{zi} = 0$, which is linear in $\\dot{u}_i$"
    free.root(f_z, compression_rate, -u_i / tau, reason, left=_RATE, right=r"-\frac{u_i}{\tau}")
    return [*found, free.done(compression_rate, -u_i / tau)]


def _separation() -> list[Derivation]:
    """Derive when an element detaches from the indenter, and its motion then."""
    found = []
    cases = (
        (23, "fixed", "eq5", -slope * V, slope * V * tau, ""),
        (24, "movable", "eq7", -slope * V + depth_rate, slope * V * tau + z_a.diff(t) * tau,
         r" + \dot{z}_{\mathrm{A}} \tau"),
    )  # fmt: skip
    for number, kind, kinematics, rate, bound, more in cases:
        stay = _equation(f"eq{number}", number, title=f"Condition of contact, {kind} indenter")
        stay.recall("eq12", f_z, k * u_i + c * compression_rate)
        stay.recall("eq21", tau, c / k)
        stay.recall(kinematics, compression_rate, rate)
        if more:
            stay.recall("eq19", depth_rate, -z_a.diff(t))
        reason = r"the foundation can only push: $f_{zi} \ge 0$, divided by $k > 0$"
        shown: Shown = {"left": "u_i", "right": rf"{_SLOPE} V \tau{more}"}
        stay.equivalent(f_z, u_i, bound, reason, **shown)
        found.append(stay.done(u_i, bound))

    decay = _equation("eq25", 25, title="Compression of a free element")
    decay.recall("eq20", compression_rate, -u_i / tau)
    growth, start = sp.exp((t - t_0) / tau), u_i.subs(t, t_0)
    left = r"\frac{\mathrm{d}}{\mathrm{d}t} \left[u_i \exp\frac{t - t_0}{\tau}\right]"
    decay.equal((u_i * growth).diff(t), sp.S.Zero, "the product keeps its value", left=left)
    result = start * sp.exp(-(t - t_0) / tau)
    shown = {"left": "u_i(t)", "right": r"u_i(t_0) \exp\left(-\frac{t - t_0}{\tau}\right)"}
    decay.root(u_i * growth - start, u_i, result, "its value at $t_0$ is $u_i(t_0)$", **shown)
    return [*found, decay.done(u_i, result)]
