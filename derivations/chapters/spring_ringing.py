"""How the dampers of a contact resist a motion along it: the ringing of a stiff spring fades (F22)."""

import sympy as sp

from ..engine.chapter import Chapter
from ..engine.nomenclature import letter, symbol
from ..engine.step import Proof
from .spring_drive import SECTION, along, damper, eps_x, kappa_x
from .theorems import lam
from .transient_edges import left, right
from .transient_memory import time
from .transient_motion import CONTACT
from .transient_scaling import PRESSURE, d_s, eps, xi

slides_more = symbol("v_x", r"change of $\lambda$", latex=r"\check v_x", real=True)
sinks_faster = symbol("v_z", "change of $d'$", latex=r"\check v_z", real=True)
letter(r"\check d", "change of $d$ while the spring rings")
length = symbol("l_c", "length of the contact", latex=r"\check l")
middle = symbol("c_m", "middle of the contact", latex=r"\check \xi", real=True)
power = symbol(
    "Pi_c", "power that both changes cost in the dampers", latex=r"\check \Pi", real=True
)

result = Chapter(SECTION)

RESISTANCE = length**3 / 4
"""Of the contact to a motion along it, at least."""
_change = sinks_faster - 2 * xi * slides_more
_follows = 2 * middle * slides_more
_PUSHED = sp.Rational(3, 4) * length * (sinks_faster - _follows)
_RUBBED = RESISTANCE * slides_more - 2 * middle * _PUSHED
"""By how much both forces change."""


@result("F22-dampers", uses=("scaled-pressure", "F11"))
def _dampers(proof: Proof) -> None:
    r"""The dampers of a contact resist.

    If the foundation slides faster by $\check v_x$ and the indenter sinks faster by $\check v_z$, the dampers
    between the edges $\ell < r$ take the power $\check \Pi$. However the depth follows, it is no less than
    $\check l^3 \check v_x^2/4$.
    """
    proof.where(sp.Gt(right - left, 0), "there is a contact")
    proof.define(length, right - left)
    proof.define(middle, (left + right) / 2)
    proof.notation[r"\hat p"] = PRESSURE
    for variable, slope, latex in ((d_s, sp.S.One, "d'"), (lam, -2 * xi, r"\lambda")):
        proof.equal(sp.Derivative(PRESSURE, variable), slope, "only the dampers feel a rate",
                    left=rf"\frac{{\partial \hat p}}{{\partial {latex}}}")  # fmt: skip
    pushes, rubs = sp.Rational(3, 4) * _change, -sp.Rational(3, 2) * xi * _change
    lost = sp.expand(sinks_faster * pushes + slides_more * rubs)
    proof.integral(
        *(power, lost, CONTACT, sp.integrate(lost, xi), "both forces times their changes of rate"),
        value=_PUSHED * (sinks_faster - _follows) + RESISTANCE * slides_more**2,
    )  # fmt: skip
    for force, value, reason in (
        (pushes, _PUSHED, r"none where $\check v_z = 2 \check \xi \check v_x$: the depth follows"),
        (sp.expand(rubs), _RUBBED, "and then the resistance alone is left"),
        (3 * (xi - middle) ** 2, RESISTANCE, "it is a moment of the contact"),
    ):
        whole = sp.Integral(force, CONTACT)
        proof.integral(whole, force, CONTACT, sp.integrate(force, xi), reason, value=value)
    proof.holds(power, ">=", RESISTANCE * slides_more**2, "and that is least")
    proof.done(whole, RESISTANCE)


@result("F22-ringing", uses=("F22-scaled", "F22-dampers"))
def _ringing(proof: Proof) -> None:
    r"""A stiff spring rings off.

    A ringing that is fast beside the retardation time, while the edges stay: $\check x$ along the foundation,
    $\check d$ normal to it, $\check v_x = -\check x'$ and $\check v_z = \check d'$. Its energy falls at least
    as that of an oscillator with the damper $\check l^3/4 + c_x$, however the depth follows.
    """
    place, deeper = sp.Function(str(along), real=True)(time), sp.Function("d_r", real=True)(time)
    moves, sinks = sp.Derivative(place, time), sp.Derivative(deeper, time)
    proof.notation |= {r"\check x": place, r"\check d": deeper}
    changes = {sinks_faster: sinks, slides_more: -moves}
    pushed, rubbed = _PUSHED.subs(changes), _RUBBED.subs(changes)
    proof.define(sp.Derivative(deeper, (time, 2)), -pushed / eps, "F22-dampers", left=r"\check d''",
                 right=r"-\frac{3 \check l}{4 \varepsilon} \left(\check d' + "
                 r"2 \check \xi \check x'\right)")  # fmt: skip
    proof.define(
        *(sp.Derivative(place, (time, 2)), (rubbed - damper * moves - kappa_x * place) / eps_x),
        "F22-dampers, F22-scaled", left=r"\check x''",
        right=r"\frac{1}{\varepsilon_x} \left[-\frac{\check l^3 \check x'}{4} - "
        r"\frac{3 \check \xi \check l}{2} \left(\check d' + 2 \check \xi \check x'\right) "
        r"- c_x \check x' - \kappa_x \check x\right]",
    )  # fmt: skip
    stored = (eps * sinks**2 + eps_x * moves**2 + kappa_x * place**2) / 2
    fades = -(RESISTANCE + damper) * moves**2 + pushed * (2 * middle * -moves - sinks)
    proof.equal(
        *(sp.Derivative(stored, time), fades, "the last term is never positive"),
        left=r"\frac{d}{ds} \left[\frac{\varepsilon \check d'^2}{2} + \frac{\varepsilon_x \check x'^2}{2} "
        r"+ \frac{\kappa_x \check x^2}{2}\right]",
        right=r"-\left(\frac{\check l^3}{4} + c_x\right) \check x'^2 - \frac{3 \check l}{4} "
        r"\left(\check d' + 2 \check \xi \check x'\right)^2",
    )  # fmt: skip
