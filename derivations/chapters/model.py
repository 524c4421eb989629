"""The model: Eqs. 1-25, from the shape of the indenter to the free elements behind it."""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, letter, symbol, symbols
from ..engine.step import Proof

R = symbol("R", "radius of the indenter", "m", source="")
M = symbol("M", "mass of the indenter per unit width", "kg/m", source="")
K = symbol("K", "stiffness of the foundation per unit area", "N/m³", source="")
C = symbol("C", "damping of the foundation per unit area", "N s/m³", source="")
tau = symbol("tau", "retardation time, $C/K$", "s")
N = symbol("N", "number of elements per unit length", "1/m")
k = symbol("k", "stiffness of one element per unit width, $K/N$", "N/m²")
c = symbol("c", "damping of one element per unit width, $C/N$", "N s/m²")
V = symbol("V", "drive velocity", "m/s", source="")
g = symbol("g", "gravity", "m/s²", source="")
t = symbol("t", "time", "s", source="coordinate", real=True)
t_0 = symbol("t_0", "time at which an element leaves the indenter", "s", real=True)
x = symbol("x", "coordinate along the foundation", "m", source="coordinate", real=True)
z = function("z", "vertical coordinate", "m", source="coordinate", real=True)
letter("i", "index of an element", source="counter")
h = function("h", "shape function of the indenter", "m", real=True)
x_i = function("x_i", "position of an element", "m", real=True)(t)
u_i = function("u_i", "compression of an element", "m", real=True)(t)
theta, f_n, f_c, f_z, f_x, F_z, F_x, delta = symbols(r"""
    -        u                m    compression of the foundation  from eq4
    theta_i  -                1    inclination of the indenter at an element  real
    f_Ni     f_{\mathrm{N}i}  N/m  normal force on an element per unit width  real
    f_Ci     f_{\mathrm{C}i}  N/m  constraint force on an element per unit width  real
    f_zi     f_{zi}           N/m  vertical force of an element per unit width  real
    f_xi     f_{xi}           N/m  horizontal force of an element per unit width  real
    F_z      -                N/m  vertical force per unit width  real
    F_x      -                N/m  horizontal force per unit width  real
    delta    -                m    indentation depth
""")
delta_t = function("delta", positive=True)(t)
letter("e", "base of natural logarithms", source="constant")
letter(r"\pi", "circumference of a circle over its diameter", source="constant")
z_a = function("z_A", real=True)(t)

slope = h(x_i).diff(x_i)
"""h'(x_i)."""
compression_rate, depth_rate = u_i.diff(t), delta_t.diff(t)

_FORCE = k * u_i + c * compression_rate
result = Chapter("Model")


@result("eq1")
def _fixed_surface(proof: Proof) -> None:
    """Surface of the fixed indenter."""
    proof.define(z(x), h(x) - delta, "the depth is constant")


@result("eq2")
def _movable_surface(proof: Proof) -> None:
    """Surface of the movable indenter."""
    proof.define(z(x), h(x) - delta_t, "the depth varies")


@result("eq3")
def _shape(proof: Proof) -> None:
    """Shape of the indenter."""
    proof.define(h(x), x**2 / (2 * R), "a cylinder of radius $R$, small slopes")


def _compression(proof: Proof, surface: str, depth: sp.Expr) -> None:
    proof.recall(surface, reason="where the element is", at={x: x_i})
    proof.define(u_i, -z(x_i), "the free surface of the foundation is $z = 0$")
    proof.equal(u_i, -h(x_i) + depth, "the surface of the indenter")


def _compression_rate(proof: Proof, compression: str, depth: sp.Expr) -> None:
    proof.recall(compression)
    proof.define(x_i.diff(t), V, "the base carries the element")
    proof.equal(compression_rate, -slope * V + depth.diff(t), "chain rule")


for _number, _who, _depth in ((4, "fixed", delta), (6, "movable", delta_t)):
    result(f"eq{_number}", title=f"Compression under the {_who} indenter",
           surface=f"eq{_number // 2 - 1}", depth=_depth)(_compression)  # fmt: skip
    result(f"eq{_number + 1}", title=f"Compression rate, {_who} indenter",
           compression=f"eq{_number}", depth=_depth)(_compression_rate)  # fmt: skip


@result("eq8")
def _vertical(proof: Proof) -> None:
    """Vertical balance of an element."""
    reason = "no mass at its tip, no force from neighbours"
    proof.define(_FORCE, f_n * sp.cos(theta), reason)


@result("eq9")
def _horizontal(proof: Proof) -> None:
    """Horizontal balance of an element."""
    proof.define(f_c, f_n * sp.sin(theta), "the tip of the element has no mass")


@result("eq10")
def _inclination(proof: Proof) -> None:
    r"""Inclination of the surface.

    The inclination is within $-\pi/2 < \theta_i < \pi/2$, so $\cos\theta_i > 0$.
    """
    proof.define(theta, -sp.atan(slope))
    proof.equal(sp.tan(theta), -slope, "its tangent")


@result("eq11")
def _normal(proof: Proof) -> None:
    """Normal force on an element."""
    proof.recall("eq8", "eq10", theta)
    proof.equal(f_n, _FORCE / sp.cos(theta), r"divide by $\cos\theta_i > 0$")


@result("eq12")
def _up(proof: Proof) -> None:
    """Vertical force on the indenter."""
    proof.recall("eq8")
    proof.define(f_z, f_n * sp.cos(theta), "the reaction has this vertical component")
    proof.equal(f_z, _FORCE, "the same product")


@result("eq13")
def _along(proof: Proof) -> None:
    """Horizontal force on the indenter."""
    proof.recall("eq10", theta)
    proof.define(f_x, f_n * sp.sin(theta), "the reaction has this horizontal component")
    proof.define(f_z, f_n * sp.cos(theta), "and this vertical one")
    proof.recall("eq9")
    proof.equal(f_c, f_x, "the constraint force is the horizontal force")
    reason = r"$\sin\theta_i = \tan\theta_i \cos\theta_i$"
    proof.equal(f_x, -slope * f_z, reason)


def _total(proof: Proof, total: sp.Symbol, name: str) -> None:
    i = sp.Symbol("i", integer=True)
    every = sp.Sum(sp.IndexedBase(name)[i], (i, 1, sp.oo))
    proof.define(total, every, "all elements act on the indenter")


result("eq14", title="Total vertical force", total=F_z, name="f_z")(_total)
result("eq15", title="Total horizontal force", total=F_x, name="f_x")(_total)


@result("eq16")
def _held(proof: Proof) -> None:
    """Position of the fixed indenter."""
    reason = r"the lowest point A stays at the depth $\delta$"
    proof.define(z_a, -delta, reason)


@result("eq17")
def _motion(proof: Proof) -> None:
    """Motion of the movable indenter."""
    proof.define(M * z_a.diff(t, 2), F_z - M * g, "Newton's law")


@result("eq18")
def _depth_of_lowest_point(proof: Proof) -> None:
    """Depth of the movable indenter."""
    proof.recall("eq2", reason="the lowest point A", at={x: sp.S.Zero})
    proof.recall("eq3", at={x: sp.S.Zero})
    proof.define(z_a, z(0), "its height")
    proof.equal(delta_t, -z_a, "$h(0) = 0$")


@result("eq19")
def _depth_rate(proof: Proof) -> None:
    """Rate of the depth."""
    proof.recall("eq18")
    proof.equal(depth_rate, -z_a.diff(t), "derivative with respect to time")


@result("eq21")
def _element_time(proof: Proof) -> None:
    """Retardation time of an element."""
    proof.define(tau, c / k)


@result("eq20")
def _free(proof: Proof) -> None:
    """Relaxation of a free element."""
    proof.recall("eq12", "eq21")
    reason = r"without contact $f_{zi} = 0$, which is linear in $\dot{u}_i$"
    proof.root(f_z, compression_rate, -u_i / tau, reason)


@result("eq22")
def _retardation_time(proof: Proof) -> None:
    """Retardation time of the foundation."""
    proof.recall("eq21")
    proof.define(k, K / N, "stiffness of one of $N$ elements per unit length")
    proof.define(c, C / N, "and its damping")
    proof.equal(tau, C / K, "$N$ cancels")


def _stay(proof: Proof, rates: tuple[str, ...], bound: sp.Expr) -> None:
    proof.recall("eq12", "eq21", *rates)
    reason = r"the foundation can only push: $f_{zi} \ge 0$, divided by $k > 0$"
    proof.equivalent(f_z, u_i, bound, reason)


result("eq23", title="Condition of contact, fixed indenter",
       rates=("eq5",), bound=slope * V * tau)(_stay)  # fmt: skip
result("eq24", title="Condition of contact, movable indenter", rates=("eq7", "eq19"),
       bound=slope * V * tau + z_a.diff(t) * tau)(_stay)  # fmt: skip


@result("eq25")
def _decay(proof: Proof) -> None:
    """Compression of a free element."""
    proof.recall("eq20")
    growth, start = sp.exp((t - t_0) / tau), u_i.subs(t, t_0)
    proof.equal(sp.Derivative(u_i * growth, t), sp.S.Zero, "the product keeps its value")
    later = start * sp.exp(-(t - t_0) / tau)
    proof.root(u_i * growth - start, u_i, later, "its value at $t_0$ is $u_i(t_0)$")
