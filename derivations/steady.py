"""Steady sliding: edges, pressure, load and friction, exactly (Eqs. 26-32 and 34-39)."""

from functools import partial

import sympy as sp

from .model import compression_rate, depth_rate, slope
from .record import Derivation
from .step import Proof
from .symbols import (
    C,
    F,
    K,
    Lambda,
    R,
    V,
    W,
    a,
    delta,
    delta_t,
    h,
    l,
    l_r,
    mu,
    p,
    q,
    t,
    t_0,
    tau,
    u_i,
    x,
    x_i,
    x_le,
    x_te,
)  # fmt: skip

SECTION = "Steady sliding"

half_length = sp.sqrt(2 * R * delta)
trailing_edge = sp.sqrt(a**2 + l_r**2) - l_r
pressure = K * (delta - x**2 / (2 * R) - l_r * x / R)
number = (1 - q**2) / (2 * q)
"""l_r/a in terms of q = x_TE/a."""
load = K * delta * a * (1 + q) ** 2 * (q**2 - 2 * q + 3) / (6 * q)
friction = K * delta * a**2 / R * (1 - q) * (1 + q) ** 2 * (q**2 - q + 4) / (12 * q)
friction_coefficient = a * (1 - q) * (q**2 - q + 4) / 2 / (R * (q**2 - 2 * q + 3))
drive_cubed = 3 * (1 - q) ** 3 * (1 + q) / (2 * q**2 * (q**2 - 2 * q + 3))
"""Lambda**3 of the dead-weight indenter."""

_SHAPE = x**2 / (2 * R)
_equation = partial(Proof, section=SECTION)


def derive() -> tuple[Derivation, ...]:
    """Derive Eqs. 26-32 and 34-39 and the exact load, friction force and friction coefficient."""
    half, retardation = _half_length(), _retardation_length()
    pressed, leading, trailing, scaled = _pressure(), _leading_edge(), _trailing_edge(), _scaled()
    coefficient = _equation("eq37", 37, title="Friction coefficient")
    coefficient.define(mu, F / W, "of steady sliding")
    return (
        *(pressed, leading, trailing, half, retardation, scaled),
        *(_limit(*case) for case in _LIMITS[:2]),
        *(_moving_leading_edge(), *_steadiness(), coefficient.done(mu, F / W)),
        *(_limit(*case) for case in _LIMITS[2:]),
        *(*_forces(), _dead_weight()),
    )


def _half_length() -> Derivation:
    proof = _equation("eq28", 28, title="Half length of the stationary contact")
    proof.recall("eq3", h(x), _SHAPE)
    reason = "at the edge of a contact at rest $h(a) = \\delta$"
    proof.root(
        *(h(x) - delta, x, half_length, reason),
        over=(x, 0, sp.oo),
        name=a,
        right=r"\sqrt{2 R \delta}",
    )
    proof.equal(delta, a**2 / (2 * R), "solved for the depth")
    return proof.done(a, half_length)


def _retardation_length() -> Derivation:
    start = u_i.subs(t, t_0)
    surface = sp.Lambda(x, start * sp.exp((x_te - x) / (V * tau)))
    proof = _equation("eq29", 29, title="Retardation length", text=_FREE_SURFACE,
                      notation={"u": surface})  # fmt: skip
    proof.define(l_r, V * tau)
    decay = start * sp.exp(-(t - t_0) / tau)
    later = {t: t_0 + (x - x_te) / V}
    proof.recall("eq25", u_i, decay, "it left the trailing edge at $t_0$", at=later)
    result = start * sp.exp(-(x - x_te) / l_r)
    shown = r"u(x_{\mathrm{TE}}) \exp\left(-\frac{x - x_{\mathrm{TE}}}{l_{\mathrm{r}}}\right)"
    reason = r"$l_{\mathrm{r}}$ is its e-folding length"
    proof.equal(u_i.subs(later), result, reason, left="u(x)", right=shown)
    proof.recall("eq22", tau, C / K)
    proof.equal(C, K * l_r / V, "with Eq. (22), solved for the damping")
    return proof.done(l_r, V * tau)


_FREE_SURFACE = "Behind the contact the surface relaxes within this length."


def _pressure() -> Derivation:
    proof = _equation("pressure", None, title="Pressure in the contact", text=_PRESSURE)
    proof.recall("eq3", h(x), _SHAPE)
    proof.recall("eq22", tau, C / K)
    proof.recall("eq29", l_r, V * tau)
    whole = K * (delta - h(x)) - C * V * h(x).diff(x)
    shown = r"K \left(\delta - h\right) - C V h'"
    proof.define(p, whole, "$N f_{zi}$ of Eqs. (12), (4) and (5)", right=shown)
    proof.equal(p, pressure, "$C V = K l_{\\mathrm{r}}$")
    return proof.done(p, pressure)


_PRESSURE = (
    r"Force per area is $p = N f_{zi}$, with $K = N k$ and $C = N c$; a steady contact is the same "
    r"under both indenters."
)


def _leading_edge() -> Derivation:
    proof = _equation("eq26", 26, title="Leading edge", text=_TOUCH,
                      notation={"p": sp.Lambda(x, pressure)})  # fmt: skip
    proof.recall("eq28", a, half_length)
    proof.recall("eq3", h(x), _SHAPE)
    proof.recall("eq22", tau, C / K)
    proof.recall("eq29", l_r, V * tau)
    proof.root(*(delta - h(x), x, -a, "$h = \\delta$ with $x < 0$"), over=(x, -sp.oo, 0), name=x_le)
    at_edge = pressure.subs(x, -a)
    proof.equal(at_edge, C * V * a / R, "positive, so the contact begins", left="p(-a)")
    s = sp.Symbol("s", positive=True)
    reason = r"ahead of it, at $x = -a (1 + s)$, this is $(\delta - h)/\delta$: no contact"
    proof.sign(1 - (1 + s) ** 2, "<", 0, (s, 0, sp.oo), reason)
    return proof.done(x_le, -a)


_TOUCH = "The leading edge is where the undisturbed surface meets the indenter."


def _trailing_edge() -> Derivation:
    proof = _equation("eq27", 27, title="Trailing edge", text=_PEEL,
                      notation={"p": sp.Lambda(x, pressure)})  # fmt: skip
    proof.recall("eq28", a, half_length)
    proof.recall("pressure", p, pressure)
    proof.equal(sp.Derivative(p, (x, 2)), -K / R, "the pressure is concave in $x$", left="p''(x)")
    ahead = pressure.subs(x, -a)
    proof.equal(ahead, K * l_r * a / R, "positive at the leading edge", left="p(-a)")
    proof.equal(pressure.subs(x, a), -K * l_r * a / R, "negative at $x = a$", left="p(a)")
    proof.root(p, x, trailing_edge, "so it vanishes exactly once between them, at the trailing edge",
               over=(x, -a, sp.oo), name=x_te,
               right=r"\sqrt{a^2 + l_{\mathrm{r}}^2} - l_{\mathrm{r}}")  # fmt: skip
    return proof.done(x_te, trailing_edge)


_PEEL = (
    "The trailing edge is where the pressure vanishes; it is the only such point of the contact."
)


def _scaled() -> Derivation:
    title = "Scaled retardation length and trailing edge"
    proof = _equation("scaling", None, title=title, text=_RATIONAL)
    proof.recall("eq27", x_te, trailing_edge)
    proof.recall("eq22", tau, C / K)
    proof.recall("eq29", l_r, V * tau)
    proof.define(l, l_r / a)
    proof.define(q, x_te / a)
    proof.equal(x_te, a * q, "by definition")
    proof.equal(l_r, a * l, "by definition")
    proof.equal(l, number, "Eq. (27) solved for $l$; at rest $q = 1$, and $q$ falls to 0")
    proof.equal(V, K * l_r / C, "Eqs. (22) and (29)")
    return proof.done(l, number)


_RATIONAL = (
    r"With $l = l_{\mathrm{r}}/a$ and $q = x_{\mathrm{TE}}/a$ all of steady sliding is rational in "
    "$q$, which runs from 1 at rest to 0 at high velocity."
)


def _limit(equation: int, slow: bool, steady: bool, who: str) -> Derivation:
    proof = _equation(
        f"eq{equation}", equation, title=f"Edges at {who}", text=_EDGES[slow] + _EITHER * steady
    )
    proof.recall("eq26", x_le, -a)
    _recall_scaled(proof)
    small = l_r / a
    if steady:
        proof.recall("scaling", V, K * l_r / C)
        small = C * V / (K * a)
    limit = a if slow else a**2 / (2 * l_r)
    if slow:
        proof.leading_order(x_te, limit, q, 1, "$q \\to 1$: hardly any peeling", eps=small)
    else:
        proof.leading_order(x_te, limit, q, 0, "$q \\to 0$: complete peeling", eps=1 / small)
    return proof.pair((x_le, -a), (x_te, limit), "both edges")


_LIMITS = (
    (30, True, False, "low velocity, fixed indenter"),
    (31, False, False, "high velocity, fixed indenter"),
    (38, True, True, "low velocity, steady sliding"),
    (39, False, True, "high velocity, steady sliding"),
)
_EITHER = (
    r" By Eqs. (34) to (36) this holds for either indenter, with its depth in steady sliding; "
    r"$l_{\mathrm{r}}/a = C V/(K a)$."
)
_EDGES = {
    True: r"For $l_{\mathrm{r}} \ll a$ the edges tend to $(-a, a)$.",
    False: r"For $l_{\mathrm{r}} \gg a$ the edges tend to $(-a, 0)$.",
}


def _moving_leading_edge() -> Derivation:
    half = sp.sqrt(2 * R * delta_t)
    edge = {"a": sp.Lambda(t, half), r"\dot{x}_{\mathrm{LE}}": (-half).diff(t)}
    proof = _equation("eq32", 32, title="Leading edge of the movable indenter", text=_OUTWARD,
                      notation=edge)  # fmt: skip
    proof.recall("eq3", h(x), _SHAPE)
    reason = "the undisturbed surface meets the indenter, $h = \\delta(t)$"
    proof.root(delta_t - h(x), x, -half, reason, over=(x, -sp.oo, 0), name=x_le, right="-a(t)")
    proof.equal(
        C * (half * V / R + depth_rate),
        C * half / R * (V - (-half).diff(t)),
        "Eq. (7): the pressure there",
        left=r"C \left(\frac{a V}{R} + \dot{\delta}\right)",
        right=r"\frac{C a}{R} \left(V - \dot{x}_{\mathrm{LE}}\right)",
    )
    return proof.done(x_le, -half)


_OUTWARD = (
    r"Here $a(t) = \sqrt{2 R \delta(t)}$. The pressure at this edge is positive while "
    r"$\dot{x}_{\mathrm{LE}} < V$: the edge moves onto undisturbed ground."
)


def _steadiness() -> list[Derivation]:
    steady = _equation("eq34", 34, title="Steady sliding")
    steady.define(depth_rate, sp.S.Zero, "the depth no longer changes", left=r"\dot{\delta}")
    found = [steady.done(depth_rate, 0)]

    pressed = _equation("eq35", 35, title="Compression in steady sliding")
    pressed.recall("eq6", u_i, -h(x_i) + delta_t)
    pressed.define(delta_t, delta, "constant, by Eq. (34)", left=r"\delta(t)")
    pressed.equal(u_i, -h(x_i) + delta, "Eq. (6) becomes Eq. (4)", left="u_i(t)",
                  right=r"-h(x_i) + \delta")  # fmt: skip
    found.append(pressed.done(u_i, -h(x_i) + delta))

    rate = _equation("eq36", 36, title="Compression rate in steady sliding")
    rate.recall("eq7", compression_rate, -slope * V + depth_rate)
    rate.recall("eq34", depth_rate, sp.S.Zero)
    rate.equal(compression_rate, -slope * V, "Eq. (7) becomes Eq. (5)", left=r"\dot{u}_i(t)",
               right="-h'(x_i) V")  # fmt: skip
    return [*found, rate.done(compression_rate, -slope * V)]


def _recall_contact(proof: Proof) -> None:
    """Let edges and pressure be rational in q."""
    proof.recall("eq28", a, half_length)
    proof.recall("eq26", x_le, -a)
    proof.recall("pressure", p, pressure)
    _recall_scaled(proof)


def _recall_scaled(proof: Proof) -> None:
    for lhs, rhs in ((x_te, a * q), (l_r, a * l), (l, number)):
        proof.recall("scaling", lhs, rhs)


def _forces() -> list[Derivation]:
    """Integrate the pressure over the contact."""
    up = _equation("load", None, title="Exact load")
    _recall_contact(up)
    primitive = K * (delta * x - x**3 / (6 * R) - l_r * x**2 / (2 * R))
    up.integral(W, p, (x, x_le, x_te), primitive, "Eq. (14) for a dense row", value=load)

    along = _equation("friction", None, title="Exact friction force")
    _recall_contact(along)
    primitive = -K / R * (delta * x**2 / 2 - x**4 / (8 * R) - l_r * x**3 / (3 * R))
    reason = "Eqs. (13) and (15) for a dense row"
    along.integral(F, -x / R * p, (x, x_le, x_te), primitive, reason, value=friction)
    found = [up.done(W, load), along.done(F, friction)]

    ratio = _equation("coefficient", None, title="Exact friction coefficient")
    ratio.recall("load", W, load)
    ratio.recall("friction", F, friction)
    ratio.recall("eq37", mu, F / W)
    ratio.equal(mu, friction_coefficient, "common factors cancel")
    return [*found, ratio.done(mu, friction_coefficient)]


def _dead_weight() -> Derivation:
    proof = _equation("drive", None, title="Drive number of the dead-weight indenter")
    for label, lhs, rhs in (
        ("eq28", a, half_length),
        ("eq22", tau, C / K),
        ("load", W, load),
        ("scaling", V, K * l_r / C),
        ("scaling", l_r, a * l),
        ("scaling", l, number),
    ):
        proof.recall(label, lhs, rhs)
    drive = V * tau * (K / (R * W)) ** sp.Rational(1, 3)
    proof.define(Lambda, drive, right=r"V \tau \left(\frac{K}{R W}\right)^{1/3}")
    proof.equal(Lambda**3, drive_cubed, "$\\delta$ cancels: one number describes the state")
    return proof.done(Lambda**3, drive_cubed)
