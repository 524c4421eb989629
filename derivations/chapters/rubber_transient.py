r"""The transient on a Prony series without elements: two accumulators and two moments for each arm (F23).

An element of the foundation is named by xi = x - Y, where Y' = v is the sliding velocity. Everything is
linear in the relaxation function, so that one arm is enough; the forces of several arms add up.
"""

import sympy as sp
from sympy.printing.latex import LatexPrinter

from ..engine.chapter import Chapter
from ..engine.nomenclature import function, symbol, symbols
from ..engine.rules import Computed
from ..engine.step import Proof
from .model import C, K, R, delta_t, t, x
from .relaxation import spring_1, spring_2
from .viscoelastic_limits import rates

le_t = function("x_LE", negative=True)
te_t = function("x_TE", real=True)
K_i = symbol("K_i", "stiffness of an arm per unit area", "N/m³", source="")
tau_i = symbol("tau_i", "relaxation time of an arm", "s", source="")
I_n = (
    symbol("I_0", "length of the contact", "m", real=True),
    symbol("I_1", "integral of $x$ over the contact", "m²", real=True),
    symbol("I_2", "integral of $x^2$ over the contact", "m³", real=True),
)
Y_t = function("Y", "distance slid", "m", printed=r"X_{\mathrm{s}}", real=True)(t)
v_t = function("v", "sliding velocity", "m/s", printed=r"V_{\mathrm{s}}", source="", real=True)(t)
xi, t_1, t_in = symbols(r"""
    xi    \xi              m  element of the foundation, $x - X_{\mathrm{s}}$  prints \tilde \xi  real
    t_1   -                s  present time  real
    t_in  t_{\mathrm{in}}  s  time at which an element entered the contact  real
""")
alpha_i = function("alpha_i", "accumulated depth that an arm remembers", "m", real=True)
beta_i = function("beta_i", "accumulated sliding distance that an arm remembers", "m", real=True)
E_i = symbol("E_i", "share of a stress at entry that an arm still has")
stress_i = function("s_i", "stress of an arm in an element", "Pa", real=True)
S_i = function("S_i", "integral of the stress of an arm over the contact", "N/m", real=True)(t)
T_i = function("T_i", "first moment of the stress of an arm over the contact", "N", real=True)(t)
glassy = symbol("K_g", "glassy stiffness", "N/m³", latex=r"K_{\mathrm{g}}")
fading_rate = symbol("rho_r", "rate of the free surface", "1/s", latex=r"\tilde \varrho", real=True)

result = Chapter("Rubber in transient sliding")

RATE = delta_t.diff(t) - v_t * (xi + Y_t) / R
"""Of the compression of an element in contact."""
ACCUMULATE = {
    alpha_i: delta_t.diff(t) - v_t * Y_t / R - alpha_i(t) / tau_i,
    beta_i: v_t - beta_i(t) / tau_i,
}
STRESS = K_i * (alpha_i(t_1) - E_i * alpha_i(t_in) - xi / R * (beta_i(t_1) - E_i * beta_i(t_in)))
SLOPE = -K_i / R * (beta_i(t_1) - E_i * beta_i(t_in) + E_i * le_t(t_in))
"""Of this stress over the elements that have entered."""
_leaves = stress_i(te_t(t) - Y_t, t) * (te_t(t).diff(t) - v_t)
MOMENTS = {
    S_i: -S_i / tau_i + K_i * (delta_t.diff(t) * I_n[0] - v_t * I_n[1] / R) + _leaves,
    T_i: -T_i / tau_i + v_t * S_i + K_i * (delta_t.diff(t) * I_n[1] - v_t * I_n[2] / R)
    + te_t(t) * _leaves,
}  # fmt: skip
"""How the moments of the stress of an arm over the contact change."""


def _slide(proof: Proof) -> None:
    proof.define(Y_t.diff(t), v_t, r"$\xi = x - Y$ names an element")


@result("F23-stress")
def _stress(proof: Proof) -> None:
    r"""Rubber: stress of an element.

    Two accumulators for each arm hold what all its elements remember: at the time $t_1$ an element that
    entered at $t_{\mathrm{in}}$ has the pressure $p = K u + \sum s_i$, which is 0 at entry. An element that
    was in contact at the start, in equilibrium, has $t_{\mathrm{in}} = 0$ and $\alpha_i = \beta_i = 0$ there.
    """
    _slide(proof)
    compression = delta_t - (xi + Y_t) ** 2 / (2 * R)
    proof.equal(sp.Derivative(compression, t), RATE, "rate of compression in the contact")
    for name in (alpha_i, beta_i):
        proof.define(name(t).diff(t), ACCUMULATE[name], "an accumulator")
    proof.define(E_i, sp.exp(-(t_1 - t_in) / tau_i), "what is left at $t_1$ of a stress at entry")
    fades = K_i * sp.exp(-(t_1 - t) / tau_i)
    over = (t, t_in, t_1)
    whole, primitive = sp.Integral(fades * RATE, over), fades * (alpha_i(t) - xi / R * beta_i(t))
    proof.integral(whole, fades * RATE, over, "stress $s_i$ of the arm", value=STRESS,
                   antiderivative=primitive)  # fmt: skip


@result("F23", uses=("F23-stress",))
def _moments(proof: Proof) -> None:
    r"""Rubber: forces of an arm in a transient.

    The forces are $F_z = K \int u\, \mathrm{d}x + \sum S_i$ and $F_x = -\frac{1}{R} [K \int x u\, \mathrm{d}x
    + \sum T_i]$: four equations for each arm replace all elements in contact.
    """
    _slide(proof)
    stress, over = stress_i(xi, t), (xi, le_t(t) - Y_t, te_t(t) - Y_t)
    proof.define(stress.diff(t), K_i * RATE - stress / tau_i, "the arm is strained, and relaxes")
    proof.define(stress_i(le_t(t) - Y_t, t), sp.S.Zero, "an element enters without stress")
    for name, power in ((S_i, 0), (T_i, 1)):
        proof.define(name, sp.Integral((xi + Y_t) ** power * stress, over), "over the contact")
    for n, name in enumerate(I_n):
        proof.define(name, sp.Integral((xi + Y_t) ** n, over), "moments of the contact")
    for name in (S_i, T_i):
        proof.equal(name.diff(t), MOMENTS[name], "elements leave at the trailing edge")
    for n, name in enumerate(I_n):
        value = (te_t(t) ** (n + 1) - le_t(t) ** (n + 1)) / (n + 1)
        proof.integral(name, (xi + Y_t) ** n, over, "an integral of a power", value=value)
    proof.done(T_i.diff(t), MOMENTS[T_i])


@result("F23-edge", uses=("F23-stress",))
def _edge(proof: Proof) -> None:
    r"""Rubber: the trailing edge in a transient.

    The pressure vanishes at the trailing edge, in the element $\xi = x_{\mathrm{TE}} - Y$ that entered when
    $\xi = x_{\mathrm{LE}}(t_{\mathrm{in}}) - Y(t_{\mathrm{in}})$: a delay that depends on the state. The
    slope of $s_i$ over the elements has the term $E_i x_{\mathrm{LE}}$ only where they have entered, not
    where they were in contact from the start: $\dot x_{\mathrm{TE}}$ jumps when $t_{\mathrm{in}}$ leaves 0.
    """
    entered = {t: t_in}
    slide = Y_t.subs(entered)
    for name, law in ((Y_t.func, v_t), *ACCUMULATE.items()):
        proof.define(name(t_in).diff(t_in), law.subs(entered), "F23-stress")
    proof.define(delta_t.subs(entered), le_t(t_in) ** 2 / (2 * R), "ground ahead is undisturbed")
    proof.define(xi, le_t(t_in) - slide, "the element that enters then")
    proof.define(E_i, sp.exp(-(t_1 - t_in) / tau_i), "F23-stress")
    slope = SLOPE * sp.Derivative(xi, t_in)
    reason = "$s_i$ from one element that enters to the next"
    proof.equal(sp.Derivative(STRESS, t_in), slope, reason)


@result("F33-forces")
def _damped(proof: Proof) -> None:
    r"""Rubber: what a damper beside the arms adds to the forces.

    Where $p = K u + C \dot u + \sum s_i$, the damper adds these to $F_z$ and to $-R F_x$ of F23, with the
    rate of compression $\dot u$ of F23-stress at $x = \xi + Y$. Both follow the velocities at once.
    """
    proof.recall("F23", *I_n)
    rate, over = C * (delta_t.diff(t) - v_t * x / R), (x, le_t(t), te_t(t))
    for n, what in ((0, "of $F_z$"), (1, "of $-R F_x$")):
        value = C * (delta_t.diff(t) * I_n[n] - v_t * I_n[n + 1] / R)
        whole = sp.Integral(x**n * rate, over)
        proof.integral(whole, whole.function, over, f"its part {what}", value=value)


class Determinant(Computed):
    """The determinant of a matrix, printed with the matrix."""

    def __new__(cls, matrix: sp.Matrix) -> "Determinant":
        """Keep the matrix as it is."""
        return sp.Expr.__new__(cls, sp.ImmutableMatrix(matrix))

    def doit(self, **_: object) -> sp.Expr:
        """Return its value."""
        return self.args[0].det(method="berkowitz")

    def _latex(self, printer: LatexPrinter) -> str:
        return rf"\det {printer._print(self.args[0])}"


@result("F23-surface")
def _surface(proof: Proof) -> None:
    r"""Rubber: the free surface.

    Behind the contact $K u + \sum s_i = 0$ and $\dot s_i = K_i \dot u - s_i/\tau_i$: a linear system,
    with $\dot u = \sum (s_i/\tau_i)/K_{\mathrm{g}}$. Here it has two arms. An element is met again where
    the indenter reaches its compression, and continues from its stresses.

    Argued: Its rates are real and negative: the free surface relaxes with as many times as there are
    arms, each longer than that of its arm.
    """
    rho, (r_1, r_2) = fading_rate, rates
    proof.where(r_2 > r_1, r"rates $1/\tau_i$ of the arms")
    proof.define(glassy, K + spring_1 + spring_2, "the glassy stiffness")
    law = Determinant([
        [rho - r_1 + spring_1 * r_1 / glassy, spring_1 * r_2 / glassy],
        [spring_2 * r_1 / glassy, rho - r_2 + spring_2 * r_2 / glassy],
    ])  # fmt: skip
    form = (
        K * (rho - r_1) * (rho - r_2)
        + spring_1 * rho * (rho - r_2)
        + spring_2 * rho * (rho - r_1)
    ) / glassy  # fmt: skip
    proof.equal(law, form, r"it vanishes where $s_i \sim e^{-\tilde \varrho t}$")
    for place, sign, where in ((0, ">", "at 0"), (r_1, "<", "at the slower rate"),
                               (r_2, ">", "at the faster one: two roots in between")):  # fmt: skip
        proof.holds(form.subs(rho, place), sign, 0, where)
    proof.done(law, form)
