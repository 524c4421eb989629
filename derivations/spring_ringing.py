"""How the dampers of a contact resist a motion along it: the ringing of a stiff spring fades (F22)."""

from functools import partial

import sympy as sp

from .record import Derivation
from .spring_drive import SECTION
from .step import Proof
from .symbols import (
    along,
    d_s,
    damper,
    eps,
    eps_x,
    kappa_x,
    lam,
    left,
    length,
    middle,
    power,
    right,
    sinks_faster,
    slides_more,
    time,
    xi,
)
from .transient_motion import CONTACT
from .transient_scaling import PRESSURE

_theorem = partial(Proof, equation=None, section=SECTION)

RESISTANCE = length**3 / 4
"""Of the contact to a motion along it, at least."""
_change = sinks_faster - 2 * xi * slides_more
_follows = 2 * middle * slides_more
_PUSHED = sp.Rational(3, 4) * length * (sinks_faster - _follows)
_RUBBED = RESISTANCE * slides_more - 2 * middle * _PUSHED
"""By how much both forces change."""


def derive() -> tuple[Derivation, ...]:
    """Prove how much the dampers take at least, and that a ringing fades at least so fast."""
    return _dampers(), _ringing()


def _dampers() -> Derivation:
    proof = _theorem("F22-dampers", title="The dampers of a contact resist", text=_RESIST,
                     uses=("scaled-pressure", "F11"))  # fmt: skip
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
    return proof.done(whole, RESISTANCE)


_RESIST = (
    r"If the foundation slides faster by $\check v_x$ and the indenter sinks faster by $\check v_z$, the "
    r"dampers between the edges $\ell < r$ take the power $\check \Pi$. However the depth follows, it is no "
    r"less than $\check l^3 \check v_x^2/4$."
)


def _ringing() -> Derivation:
    proof = _theorem("F22-ringing", title="A stiff spring rings off", text=_RINGS,
                     uses=("F22-scaled", "F22-dampers"))  # fmt: skip
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
    return proof.done(sp.Derivative(stored, time), fades)


_RINGS = (
    r"A ringing that is fast beside the retardation time, while the edges stay: $\check x$ along the "
    r"foundation, $\check d$ normal to it, $\check v_x = -\check x'$ and $\check v_z = \check d'$. Its "
    r"energy falls at least as that of an oscillator with the damper $\check l^3/4 + c_x$, however the depth "
    r"follows."
)
