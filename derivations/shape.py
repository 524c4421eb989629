"""Steady sliding of an indenter of a user's shape: edges, load, friction and both limits, and a dead weight.

The shape rises as a convex sum of powers of |x|. With q = x_TE/a everything is explicit: a is the half
length of the contact at rest, delta = h(a), and l_r follows from q. If the edges are
to follow from depth and velocity instead, they are roots, as the text says.
"""

from collections.abc import Iterator

import sympy as sp

from .chapters.model import C, K, V, delta, h, x
from .chapters.steady import F, W, a, l_r, mu, p, q
from .engine.book import established, forget, tex
from .engine.forms import reduced
from .engine.nomenclature import Symbol, symbol
from .engine.record import Derivation
from .engine.step import Proof, StepError
from .shape_text import Shape, distance, read_shape
from .shape_weight import ROWS as WEIGHT_ROWS
from .shape_weight import Weight

W_ahead, W_behind, F_ahead = (
    symbol(f"{force}_{side}", latex=rf"{force}_{{\mathrm{{{side[0]}}}}}")
    for force, side in (("W", "ahead"), ("W", "behind"), ("F", "ahead"))
)
F_behind = symbol("F_behind", latex=r"F_{\mathrm{b}}", real=True)
q_root = symbol("q_root", latex=r"\hat q")

PREMISES = ("eq22", "eq29")
UNITS = {1: "1", 2: "1/m", 3: "1/m²", 4: "1/m³"}
"""Unit of a coefficient by the power of x that it stands before."""


def title(text: str) -> str:
    """Return the title of the document for a shape."""
    return f"Steady sliding of an indenter of the shape {text}"


def derive_shape(text: str) -> tuple[Derivation, ...]:
    """Derive steady sliding for the shape that the text describes.

    Raises
    ------
    ValueError
        For text that is no shape, and for a shape that does not rise or is not convex.
    """
    shape = read_shape(text)
    steady_premises()
    forget("shape-")
    try:
        return tuple(_Chapter(shape).derive())
    except StepError as error:
        raise ValueError(f'the shape "{text}": a step is not shown: {error}') from error


def steady_premises() -> tuple[Derivation, ...]:
    """Derive what the chapter recalls: relations of the paper, which it cites."""
    from .catalogue import catalogue

    return catalogue(PREMISES)


def symbols(text: str) -> tuple[Symbol, ...]:
    """Return the rows of the nomenclature for the parameters, the sides and the length of a shape."""
    shape = read_shape(text)
    rows = [
        Symbol(tex(each), "parameter of the shape", _unit(shape, each)) for each in shape.parameters
    ]
    for force, unit, name in (("W", "N/m", "load"), ("F", "N/m", "friction force")):
        for sign, side in (("a", "ahead of"), ("b", "behind")):
            meaning = f"part of the {name} that is carried {side} the lowest line"
            rows.append(Symbol(rf"{force}_{{\mathrm{{{sign}}}}}", meaning, unit, None))
    rows.append(Symbol(tex(distance), "distance from the lowest line", "m", "shape-rise"))
    rows.append(Symbol("a", "half length of the contact at rest", "m", None))
    return (*rows, *(WEIGHT_ROWS if _is_blunt_power(shape) else ()))


def _is_blunt_power(shape: Shape) -> bool:
    """Tell whether the shape is one power with a rounded tip, of which the dead weight is derived too."""
    return len(shape.powers) == 1 and shape.powers[0] > 1


def _unit(shape: Shape, parameter: sp.Symbol) -> str:
    """Return the unit of a coefficient that stands alone before its power."""
    for power in shape.powers:
        if shape.coefficient(power) == parameter:
            return UNITS.get(power, f"m^({1 - power})")
    return "such that h is in m"


class _Chapter:
    """The derivations for one shape."""

    def __init__(self, shape: Shape) -> None:
        self.shape, self.rise = shape, shape.rise
        self.slope = sp.diff(self.rise, distance)
        order = shape.root_order
        self.variable = q_root if order > 1 else q
        self.trailing = self.variable**order * a
        self.blunt = min(shape.powers) > 1

    def derive(self) -> Iterator[Derivation]:
        yield self._rise()
        yield self._leading()
        yield self._pressure()
        yield self._trailing()
        yield self._force(W, W_ahead, W_behind, "load")
        yield self._force(F, F_ahead, F_behind, "friction")
        yield self._coefficient()
        yield from self._limits()
        if _is_blunt_power(self.shape):
            power = self.shape.powers[0]
            yield from Weight(self.shape.coefficient(power), power, self.variable).derive()

    def _proof(self, label: str, title: str, text: str = "") -> Proof:
        return Proof(
            f"shape-{label}", None, section="An indenter of this shape", title=title, text=text
        )

    def _at(self, form: sp.Expr, place: sp.Expr) -> sp.Expr:
        return form.subs(distance, place)

    def _rise(self) -> Derivation:
        proof = self._proof("rise", "Shape", _SHAPE)
        proof.define(h(x), self.rise, "the surface of the indenter")  # fmt: skip
        try:
            _signed(proof, self.slope, ">", "it rises on both sides: its slope")
            curvature = sp.diff(self.slope, distance)
            if curvature != 0:
                _signed(proof, curvature, ">=", "it is convex: its second derivative")
        except StepError as error:
            raise ValueError(
                f'the shape "{self.shape.text}" cannot be shown to rise and to be convex for x > 0, '
                f"which one contact with two edges needs ({error})"
            ) from error
        return proof.done(h(x), self.rise)

    def _leading(self) -> Derivation:
        depth = self._at(self.rise, a)
        closed = _power_root(self.shape, delta)
        text = _EXPLICIT_A if closed is not None else _IMPLICIT_A
        proof = self._proof("leading", "Leading edge", text)
        if closed is None:
            proof.define(
                delta, depth, r"$h = \delta$ at the edges of the contact at rest, $x = \pm a$"
            )
            return proof.done(delta, depth)
        reason = r"$h(a) = \delta$, and the undisturbed surface is met at $x = -a$"
        proof.root(delta - depth, a, closed, reason)
        return proof.done(a, closed)

    def _pressure(self) -> Derivation:
        form = K * (delta - self.rise - l_r * self.slope)
        proof = self._proof("pressure", "Pressure behind the lowest line")
        proof.recall("eq22")
        proof.recall("eq29")
        whole = K * (delta - self.rise) - C * V * self.slope
        proof.define(p, whole, r"$K u + C \dot u$ with $u = \delta - h$ and $\dot u = -V h'$",)  # fmt: skip
        proof.equal(p, form, r"$C V = K l_{\mathrm{r}}$; ahead of it $h'$ has the other sign")
        return proof.done(p, form)

    def _trailing(self) -> Derivation:
        depth, place = self._at(self.rise, a), self.trailing
        number = self._number()
        closed = None if len(self.shape.powers) > 1 else _edge(self.shape)
        text = _trailing_text(closed is not None, self.blunt)
        proof = self._proof("trailing", "Trailing edge", text)
        proof.recall("shape-pressure", p)
        proof.define(delta, depth, "the leading edge")
        fall = -K * (self.slope + l_r * sp.diff(self.slope, distance))
        proof.equal(sp.Derivative(p, distance), fall, _FALLS)
        if closed is not None:
            if not self.blunt:
                proof.where(sp.Lt(l_r, a), "the trailing edge is behind the tip")
            proof.root(p, distance, closed, "the positive root of $p = 0$")
        proof.define(l_r, number, r"its value for an edge at $x_{\mathrm{TE}} = q a$")
        zero = (K * (delta - self.rise - l_r * self.slope)).subs(distance, place)
        proof.equal(zero, sp.S.Zero, "no pressure there")
        return proof.done(l_r, number)

    def _number(self) -> sp.Expr:
        """Return l_r in terms of a and q."""
        depth, place = self._at(self.rise, a), self.trailing
        return _tidy((depth - self._at(self.rise, place)) / self._at(self.slope, place))

    def _state(self, proof: Proof) -> None:
        """Let depth and retardation length be expressions in a and q."""
        proof.define(delta, self._at(self.rise, a), "the leading edge")
        proof.recall("shape-trailing", l_r)

    def _force(
        self, force: sp.Symbol, ahead: sp.Symbol, behind: sp.Symbol, label: str
    ) -> Derivation:
        proof = self._proof(label, "Load" if force == W else "Friction force", _SIDES)
        self._state(proof)
        values = self._halves(force)
        for side, sign, end, name, value in (
            (ahead, 1, a, "ahead of", values[0]),
            (behind, -1, self.trailing, "behind", values[1]),
        ):
            weight = sp.S.One if force == W else sign * self.slope
            inner = sp.expand(weight * K * (delta - self.rise + sign * l_r * self.slope))
            proof.integral(side, inner, (distance, 0, end), f"{name} the lowest line", value=value,
                           antiderivative=_integral(inner))  # fmt: skip
        if force == F:
            level = self._at(self.rise, self.trailing)
            squares = _integral(sp.expand(self.slope**2))
            lost = sum(self._at(squares, end) for end in (a, self.trailing))
            proof.equal(ahead + behind, K * (delta - level) ** 2 / 2 + K * l_r * lost,
                        "the sum of both, which is positive")  # fmt: skip
        proof.define(force, ahead + behind, "both sides")
        result = _tidy(proof._resolve(sum(values)))
        proof.equal(force, result, "with the edges inserted")
        return proof.done(force, result)

    def _halves(self, force: sp.Symbol) -> tuple[sp.Expr, sp.Expr]:
        """Return what both sides carry, in terms of which as few as can be are negative.

        The load behind is that by parts, the integral of -x p', as there is no pressure at the edge.
        """
        level = self._at(self.rise, self.trailing)
        if force == F:
            squares = _integral(sp.expand(self.slope**2))
            lost = (K * l_r * self._at(squares, end) for end in (a, self.trailing))
            kept = K * delta**2 / 2, -K * (delta * level - level**2 / 2)
            return tuple(sum(parts) for parts in zip(kept, lost, strict=True))
        inside = _integral(sp.expand(distance * self.slope))
        curved = _integral(sp.expand(distance * sp.diff(self.slope, distance)))
        return (
            K * (self._at(inside, a) + l_r * delta),
            K * self._at(inside + l_r * curved, self.trailing),
        )

    def _coefficient(self) -> Derivation:
        proof = self._proof("coefficient", "Friction coefficient")
        self._recall_forces(proof)
        proof.define(mu, F / W, "Eq. (37)")
        result = established("shape-friction", F) / established("shape-load", W)
        proof.equal(mu, result, "common factors cancel")
        return proof.done(mu, result)

    def _recall_forces(self, proof: Proof) -> None:
        for label, force in (("load", W), ("friction", F)):
            proof.recall(f"shape-{label}", force)

    def _limits(self) -> Iterator[Derivation]:
        area = self._at(_integral(self.rise), a)
        squares = self._at(_integral(sp.expand(self.slope**2)), a)
        depth = self._at(self.rise, a)
        low = (2 * K * (a * depth - area), 2 * K * l_r * squares)
        high = (K * l_r * depth, K * l_r * squares)
        yield self._limit("low", "Low velocity", 1, l_r / a, low, _LOW)
        if self.blunt:
            yield self._limit("high", "High velocity", 0, a / l_r, high, _HIGH)
        else:
            yield self._sharp(area, squares, high)

    def _limit(
        self,
        label: str,
        title: str,
        end: int,
        small: sp.Expr,
        forces: tuple[sp.Expr, sp.Expr],
        text: str,
    ) -> Derivation:
        proof = self._proof(label, title, text)
        self._recall_forces(proof)
        proof.recall("shape-trailing", l_r)
        proof.define(mu, F / W, "Eq. (37)")
        ratio = sp.factor(sp.simplify(forces[1] / forces[0]))
        for force, leading in ((W, forces[0]), (F, forces[1]), (mu, ratio)):
            proof.leading_order(force, sp.factor(leading), self.variable, end, "", eps=small)
        return proof.done(mu, ratio)

    def _sharp(self, area: sp.Expr, squares: sp.Expr, high: tuple[sp.Expr, sp.Expr]) -> Derivation:
        """Derive the state in which the trailing edge is at the tip."""
        depth, tip = self._at(self.rise, a), self._at(self.slope, 0)
        proof = self._proof("tip", "High velocity: the contact ends at the tip", _TIP)
        proof.define(delta, depth, "the leading edge")
        limit = depth / tip
        proof.equal(depth - limit * tip, sp.S.Zero,
                    rf"no pressure behind the tip from $l_{{\mathrm{{r}}}} = {tex(limit)}$ on")  # fmt: skip
        load, friction = K * (a * depth - area + l_r * depth), K * (depth**2 / 2 + l_r * squares)
        for force, weight, value in ((W, sp.S.One, load), (F, self.slope, friction)):
            inner = sp.expand(weight * K * (delta - self.rise + l_r * self.slope))
            proof.integral(force, inner, (distance, 0, a), "ahead of the tip", value=sp.expand(value),
                           antiderivative=_integral(inner))  # fmt: skip
        proof.define(mu, F / W, "Eq. (37)")
        ratio = _tidy(friction / load)
        proof.equal(mu, ratio, "exactly")
        last = sp.factor(sp.simplify(high[1] / high[0]))
        if sp.simplify(ratio - last) == 0:
            return proof.done(mu, ratio)
        proof.leading_order(mu, last, l_r, sp.oo, r"$V \to \infty$", eps=a / l_r)
        return proof.done(mu, last)


def _signed(proof: Proof, form: sp.Expr, relation: str, reason: str) -> None:
    """Prove a sign for |x| > 0 by that of every term or, where a term has the other one, by Sturm."""
    try:
        proof.holds(form, relation, 0, reason)
    except StepError:
        proof.sign(form, relation, 0, (distance, 0, sp.oo), reason)


def _primitive(term: sp.Expr) -> sp.Expr:
    coefficient, rest = term.as_independent(distance, as_Add=False)
    power = rest.as_base_exp()[1] if rest != 1 else sp.S.Zero
    return coefficient * distance ** (power + 1) / (power + 1)


def _integral(form: sp.Expr) -> sp.Expr:
    """Integrate a sum of powers of the distance from 0."""
    return sp.Add(*(_primitive(term) for term in sp.Add.make_args(sp.expand(form))))


def _tidy(form: sp.Expr) -> sp.Expr:
    """Return the product of factors, with 1 - q rather than q - 1, which is negative.

    Of a sum of powers only letters and powers of 1 - q and 1 + q are looked for: to find all takes long.
    """
    parts = sp.fraction(reduced(sp.powsimp(sp.expand(form))))
    return sp.Mul(*(_factored(part) ** side for part, side in zip(parts, (1, -1), strict=True)))


def _factored(form: sp.Expr) -> sp.Expr:
    """Return a polynomial as a product."""
    found, rest = sp.factor_terms(form).as_independent(sp.Add, as_Add=False)
    if len(rest.free_symbols) == 1:
        return found * sp.factor(rest)
    for factor in (side + sign * each for each in (q, q_root) for side, sign in ((1, -1), (1, 1))):
        while rest.has(*factor.free_symbols):
            quotient, left = sp.div(rest, factor, *factor.free_symbols)
            if left != 0:
                break
            found, rest = found * factor, quotient
    return found * sp.factor_terms(rest)


def _power_root(shape: Shape, level: sp.Expr) -> sp.Expr | None:
    """Return where a single power reaches the level, or nothing for a sum."""
    if len(shape.powers) > 1:
        return None
    power = shape.powers[0]
    return (level / shape.coefficient(power)) ** (1 / power)


def _edge(shape: Shape) -> sp.Expr | None:
    """Return the trailing edge of a wedge or a parabola, whose equations are of degree 1 and 2."""
    power = shape.powers[0]
    return {1: a - l_r, 2: sp.sqrt(a**2 + l_r**2) - l_r}.get(power)


def _trailing_text(closed: bool, blunt: bool) -> str:
    form = (
        "The trailing edge has a closed form."
        if closed
        else r"The trailing edge has no closed form in the velocity: it is the root of an equation, "
        r"$h(a) - h(x_{\mathrm{TE}}) = l_{\mathrm{r}} h'(x_{\mathrm{TE}})$. With "
        r"$q = x_{\mathrm{TE}}/a$ as the parameter, everything below is explicit."
    )
    return form if blunt else f"{form} {_SHARP}"


_FALLS = "negative, as $h' > 0$ and $h'' \\ge 0$: the pressure has one zero"
_SHAPE = (
    r"In terms of the distance $\bar x = |x|$ from the lowest line; primes are derivatives with "
    r"respect to it."
)
_EXPLICIT_A = r"The half length $a$ of the contact at rest; the leading edge is at $x = -a$."
_IMPLICIT_A = (
    r"The half length $a$ has no closed form: it is the root of $h(a) = \delta$, unique because $h$ "
    r"rises. Below, $a$ is given and $\delta$ follows from it; the leading edge is at $x = -a$."
)
_SHARP = (
    "The tip is sharp: this holds while the edge is behind it; beyond, the contact ends at the tip."
)
_SIDES = r"From both sides of the lowest line, with $q = x_{\mathrm{TE}}/a$."
_LOW = r"For $l_{\mathrm{r}} \ll a$, that is $q \to 1$."
_HIGH = r"For $l_{\mathrm{r}} \gg a$, that is $q \to 0$."
_TIP = r"Above the velocity at which the trailing edge reaches the tip, $q = 0$, it stays there."
