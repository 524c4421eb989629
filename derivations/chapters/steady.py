"""Steady sliding: edges, pressure, load and friction, exactly (Eqs. 26-39)."""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbol, symbols
from ..engine.step import Proof
from .model import (
    C, F_x, F_z, K, N, R, V, c, compression_rate, delta, delta_t, depth_rate, f_x, f_z, h, k, slope,
    t, t_0, tau, u_i, x, x_i,
)  # fmt: skip

a, l_r, x_le, x_te, W, F, mu, l, q, Lambda = symbols(r"""
    a       -                m        half length of the stationary contact, $\sqrt{2 R \delta}$
    l_r     l_{\mathrm{r}}   m        retardation length, $V \tau$
    x_LE    x_{\mathrm{LE}}  m        leading edge of the contact  negative
    x_TE    x_{\mathrm{TE}}  m        trailing edge of the contact  nonnegative
    W       -                N/m      load in steady sliding per unit width
    F       -                N/m      friction force in steady sliding per unit width
    mu      -                1        friction coefficient, $F/W$
    l       -                1        scaled retardation length, $l_{\mathrm{r}}/a$
    q       -                1        scaled trailing edge, $x_{\mathrm{TE}}/a$, from 1 at rest down to 0
            at high velocity
    -       \bar s           1        distance ahead of the leading edge, over the half length
    Lambda  -                1        scaled velocity of the dead-weight model, $V \tau (K/(R W))^{1/3}$
    -       O                that of its argument  order of a remainder  from sign
""")

p = function("p", "contact pressure", "Pa", real=True)(x)

half_length = sp.sqrt(2 * R * delta)
trailing_edge = sp.sqrt(a**2 + l_r**2) - l_r
any_pressure = K * (delta - h(x)) - C * V * h(x).diff(x)
"""Of any shape."""
pressure = K * (delta - x**2 / (2 * R) - l_r * x / R)
number = (1 - q**2) / (2 * q)
"""l_r/a in terms of q = x_TE/a."""
load = K * delta * a * (1 + q) ** 2 * (q**2 - 2 * q + 3) / (6 * q)
friction = K * delta * a**2 / R * (1 - q) * (1 + q) ** 2 * (q**2 - q + 4) / (12 * q)
friction_coefficient = a * (1 - q) * (q**2 - q + 4) / 2 / (R * (q**2 - 2 * q + 3))
drive_cubed = 3 * (1 - q) ** 3 * (1 + q) / (2 * q**2 * (q**2 - 2 * q + 3))
"""Lambda**3 of the dead-weight indenter."""

CONTACT = (x, x_le, x_te)
_half = sp.sqrt(2 * R * delta_t)
_x_minus = symbol("x_-", "smaller zero of the pressure", "m", latex="x_{-}", real=True)
_x_plus = symbol("x_+", latex=r"x_{\mathrm{TE}}", real=True)
"""Zeros of the pressure; x_TE may be negative under an indenter that moves."""
TRAILING = sp.sqrt(a**2 * (1 + tau * depth_rate / delta_t) + l_r**2) - l_r
"""Eq. 33: the zeros of the pressure."""
LEADING = -sp.sqrt(a**2 * (1 + tau * depth_rate / delta_t) + l_r**2) - l_r

SECTION = "Steady sliding"
result = Chapter(SECTION)


@result("eq28")
def _half_length(proof: Proof) -> None:
    """Half length of the stationary contact."""
    proof.recall("eq3")
    reason = "at the edge of a contact at rest $h(a) = \\delta$"
    proof.root(h(x) - delta, x, half_length, reason, over=(x, 0, sp.oo), name=a)
    proof.equal(delta, a**2 / (2 * R), "solved for the depth")
    proof.done(a, half_length)


@result("eq29")
def _retardation_length(proof: Proof) -> None:
    """Retardation length.

    Behind the contact the surface relaxes within this length.
    """
    start = u_i.subs(t, t_0)
    proof.define(l_r, V * tau, "how far the base moves in the retardation time")
    later = {t: t_0 + (x - x_te) / V}
    proof.recall("eq25", reason="it left the trailing edge at $t_0$", at=later)
    result = start * sp.exp(-(x - x_te) / l_r)
    proof.equal(u_i.subs(later), result, r"$l_{\mathrm{r}}$ is its e-folding length")
    proof.recall("eq22")
    proof.equal(C, K * l_r / V, "with Eq. (22), solved for the damping")
    proof.done(l_r, V * tau)


def _force_per_area(proof: Proof, labels: tuple[str, ...], depth: sp.Expr) -> None:
    """Define the pressure, and show that it is N times the force of the element at each place."""
    proof.recall("eq3", "eq12", *labels)
    proof.recall("eq3", at={x: x_i})
    proof.recall("eq22", k, c)
    whole = K * (depth - h(x)) + C * (depth.diff(t) - V * h(x).diff(x))
    proof.define(p, whole, "force per area of a dense row")
    reason = "$N$ elements per length, each with this force"
    proof.equal(sp.Subs(p, x, x_i), N * f_z, reason)


@result("pressure")
def _pressure(proof: Proof) -> None:
    """Pressure in the contact.

    Force per area is $p = N f_{zi}$, with $K = N k$ and $C = N c$; a steady contact is the same under both
    indenters.
    """
    _force_per_area(proof, ("eq4", "eq5"), delta)
    proof.recall("eq22", "eq29")
    proof.equal(p, pressure, "$C V = K l_{\\mathrm{r}}$")


@result("pressure-moving")
def _moving_pressure(proof: Proof) -> None:
    """Pressure under a moving indenter.

    At every instant of every motion.
    """
    _force_per_area(proof, ("eq6", "eq7"), delta_t)


@result("dense-row")
def _dense_row(proof: Proof) -> None:
    r"""A dense row of elements.

    The elements stand $1/N$ apart, and $N$ is so large that sums over those in contact are integrals over the
    contact: of $p = N f_{zi}$, and by Eq. (13) of $-h' p = N f_{xi}$.
    """
    number, along = sp.Symbol("i", integer=True), -h(x).diff(x) * p
    proof.recall("eq13")
    proof.define(p.subs(x, x_i), N * f_z, "force per area")
    proof.equal(-slope * p.subs(x, x_i), N * f_x, "along the foundation, by Eq. (13)")
    for label, total, name, density in (("eq14", F_z, "f_z", p), ("eq15", F_x, "f_x", along)):
        every = sp.Sum(sp.IndexedBase(name)[number], (number, 1, sp.oo))
        proof.define(every, sp.Integral(density, CONTACT), r"a Riemann sum, as $1/N \to 0$")
        proof.recall(label)
        proof.equal(total, sp.Integral(density, CONTACT), "the total force")


@result("eq26")
def _leading_edge(proof: Proof) -> None:
    """Leading edge.

    The leading edge is where the undisturbed surface meets the indenter.
    """
    proof.recall("eq28", "eq3", "eq22", "eq29", "pressure")
    proof.root(*(delta - h(x), x, -a, "$h = \\delta$ with $x < 0$"), over=(x, -sp.oo, 0), name=x_le)
    proof.equal(sp.Subs(p, x, -a), C * V * a / R, "positive, so the contact begins")
    s = sp.Symbol("s", positive=True)
    reason = r"ahead of it, at $x = -a (1 + s)$, this is $(\delta - h)/\delta$: no contact"
    proof.sign(1 - (1 + s) ** 2, "<", 0, (s, 0, sp.oo), reason)
    proof.done(x_le, -a)


@result("eq27")
def _trailing_edge(proof: Proof) -> None:
    """Trailing edge.

    The trailing edge is where the pressure vanishes; it is the only such point of the contact.
    """
    proof.recall("eq28", "pressure")
    proof.equal(sp.Derivative(p, (x, 2)), -K / R, "the pressure is concave in $x$")
    proof.equal(sp.Subs(p, x, -a), K * l_r * a / R, "positive at the leading edge")
    proof.equal(sp.Subs(p, x, a), -K * l_r * a / R, "negative at $x = a$")
    proof.root(p, x, trailing_edge, "so it vanishes exactly once between them, at the trailing edge",
               over=(x, -a, sp.oo), name=x_te)  # fmt: skip


@result("scaling")
def _scaled(proof: Proof) -> None:
    r"""Scaled retardation length and trailing edge.

    With $l = l_{\mathrm{r}}/a$ and $q = x_{\mathrm{TE}}/a$ all of steady sliding is rational in $q$, which
    runs from 1 at rest to 0 at high velocity.
    """
    proof.recall("eq27", "eq22", "eq29")
    proof.define(l, l_r / a, "in half lengths")
    proof.define(q, x_te / a, "in half lengths")
    proof.equal(x_te, a * q, "by definition")
    proof.equal(l_r, a * l, "by definition")
    proof.equal(l, number, "Eq. (27) solved for $l$; at rest $q = 1$, and $q$ falls to 0")
    proof.equal(V, K * l_r / C, "Eqs. (22) and (29)")
    proof.done(l, number)


def _limit(proof: Proof, slow: bool, steady: bool) -> None:
    proof.recall("eq26")
    _recall_scaled(proof)
    small = l_r / a
    if steady:
        proof.recall("scaling", V)
        small = C * V / (K * a)
    limit = a if slow else a**2 / (2 * l_r)
    if slow:
        proof.leading_order(x_te, limit, q, 1, r"$q \to 1$: hardly any peeling", eps=small)
    else:
        proof.leading_order(x_te, limit, q, 0, r"$q \to 0$: complete peeling", eps=1 / small)
    proof.pair((x_le, -a), (x_te, limit), "both edges")


def _limits(slow_number: int, fast_number: int, who: str, text: str = "") -> None:
    """Add the edges at low and at high velocity."""
    for number, slow in ((slow_number, True), (fast_number, False)):
        velocity, far, ends = ("low", r"\ll", "(-a, a)") if slow else ("high", r"\gg", "(-a, 0)")
        tend = rf"For $l_{{\mathrm{{r}}}} {far} a$ the edges tend to ${ends}$."
        title = f"Edges at {velocity} velocity, {who}"
        result(f"eq{number}", title=title, text=tend + text, slow=slow, steady=bool(text))(_limit)


_limits(30, 31, "fixed indenter")


@result("eq32")
def _moving_leading_edge(proof: Proof) -> None:
    r"""Leading edge of the movable indenter.

    The pressure at this edge is positive while $\dot{x}_{\mathrm{LE}} <
    V$: the edge moves onto undisturbed ground.
    """
    proof.recall("eq3")
    proof.define(a, _half, "now depends on time")
    reason = "the undisturbed surface meets the indenter, $h = \\delta(t)$"
    proof.root(delta_t - h(x), x, -a, reason, over=(x, -sp.oo, 0), name=x_le)
    edge_rate = sp.Derivative(x_le, t)
    proof.equal(
        C * (a * V / R + depth_rate), C * a / R * (V - edge_rate), "pressure there, by Eq. (7)"
    )
    proof.done(x_le, -a)


@result("eq33")
def _peeling_edges(proof: Proof) -> None:
    """Trailing edge of the movable indenter.

    It holds while the edge peels, that is, while elements leave the contact there because their pressure
    vanishes. The paper gives one zero of the pressure; the other is a leading edge that peels, as occurs when
    the indenter is lifted faster than the edge advances onto undisturbed ground. If there is no zero, no
    element can be pressed and the indenter has left the foundation.
    """
    half = K / (2 * R)
    square = a**2 * (1 + tau * depth_rate / delta_t) + l_r**2
    proof.recall("eq3", "eq22", "eq29", "pressure-moving", p)
    proof.define(a, _half, "now depends on time")
    proof.equal(p, half * (square - (x + l_r) ** 2), r"largest at $x = -l_{\mathrm{r}}$")
    proof.where(sp.Gt(square, 0), "else no element can be pressed")
    proof.root(p, x, LEADING, "a leading edge that peels, where Eq. (32) does not hold",
               over=(x, -sp.oo, -l_r), name=_x_minus)  # fmt: skip
    proof.root(p, x, TRAILING, "the trailing edge while it peels", over=(x, -l_r, sp.oo),
               name=_x_plus)  # fmt: skip
    proof.equal(p, half * (_x_plus - x) * (x - _x_minus), "positive exactly between its zeros")
    proof.done(_x_plus, TRAILING)


@result("eq34")
def _steadiness(proof: Proof) -> None:
    """Steady sliding."""
    proof.define(depth_rate, sp.S.Zero, "the depth no longer changes")


@result("eq35")
def _steady_compression(proof: Proof) -> None:
    """Compression in steady sliding."""
    proof.recall("eq6")
    proof.define(delta_t, delta, "constant, by Eq. (34)")
    proof.equal(u_i, -h(x_i) + delta, "Eq. (6) becomes Eq. (4)")


@result("eq36")
def _steady_rate(proof: Proof) -> None:
    """Compression rate in steady sliding."""
    proof.recall("eq7", "eq34")
    proof.equal(compression_rate, -slope * V, "Eq. (7) becomes Eq. (5)")


@result("eq37")
def _coefficient(proof: Proof) -> None:
    """Friction coefficient."""
    proof.define(mu, F / W, "of steady sliding")


_limits(
    38, 39, "steady sliding",
    r" By Eqs. (34) to (36) this holds for either indenter, with its depth in steady sliding; "
    r"$l_{\mathrm{r}}/a = C V/(K a)$.",
)  # fmt: skip


def _recall_contact(proof: Proof) -> None:
    """Let edges and pressure be rational in q."""
    proof.recall("eq3", "eq28", "eq26", "pressure")
    _recall_scaled(proof)


def _recall_scaled(proof: Proof) -> None:
    proof.recall("scaling", x_te, l_r, l)


@result("load")
def _load(proof: Proof) -> None:
    """Exact load."""
    _recall_contact(proof)
    proof.recall("dense-row", F_z)
    proof.integral(F_z, p, CONTACT, "the integral of the pressure", value=load,
                   antiderivative=K * (delta * x - x**3 / (6 * R) - l_r * x**2 / (2 * R)))  # fmt: skip
    proof.define(W, F_z, "in steady sliding")
    proof.equal(W, load, "the load")


@result("friction")
def _friction(proof: Proof) -> None:
    """Exact friction force."""
    _recall_contact(proof)
    proof.recall("dense-row", F_x)
    reason = "the integral along the foundation"
    proof.integral(F_x, -h(x).diff(x) * p, CONTACT, reason, value=friction)
    proof.define(F, F_x, "in steady sliding")
    proof.equal(F, friction, "the friction force")


@result("coefficient")
def _exact_coefficient(proof: Proof) -> None:
    """Exact friction coefficient."""
    proof.recall("load", "friction", "eq37")
    proof.equal(mu, friction_coefficient, "common factors cancel")


@result("drive")
def _dead_weight(proof: Proof) -> None:
    """Drive number of the dead-weight indenter."""
    proof.recall("eq28", "eq22", "load", "scaling", V, l_r, l)
    drive = V * tau * (K / (R * W)) ** sp.Rational(1, 3)
    proof.define(Lambda, drive, "a velocity that depth does not enter")
    proof.equal(Lambda**3, drive_cubed, "$\\delta$ cancels: one number describes the state")
