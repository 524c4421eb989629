"""The catalogue is complete, sound and agrees with independent numerical work."""

import re
from dataclasses import replace

import mpmath as mp
import pytest
import sympy as sp
from kvtheory.derivations import symbols as s
from kvtheory.derivations.catalogue import CHAPTERS, SECTIONS, catalogue
from kvtheory.derivations.chapters import asymptotics, ball, groups, relaxation, steady, tables
from kvtheory.derivations.engine import book
from kvtheory.derivations.engine.algebra import difference
from kvtheory.derivations.engine.book import StepError
from kvtheory.derivations.engine.nomenclature import CONSTANTS, TEX
from kvtheory.derivations.engine.printing import doprint
from kvtheory.derivations.engine.record import STATUSES
from kvtheory.derivations.engine.step import Proof

from tests.conftest import digits
from tests.latex_reader import names_in, read

_digits = digits(50)

DIGITS = 50
SCENE = {s.R: "0.013", s.K: "2.1e9", s.C: "3.7e8", s.delta: "1.9e-4"}


def test_labels_are_unique_and_every_equation_is_there_once(by_label):
    assert len(by_label) == len(catalogue())
    numbered = {d.label: d.equation for d in catalogue() if d.equation is not None}
    assert numbered == {f"eq{n}": n for n in range(1, 51)}
    assert {"table1", "table2"} <= set(by_label)


def test_sections_stand_in_order():
    seen = list(dict.fromkeys(derivation.section for derivation in catalogue()))
    assert seen == list(SECTIONS)


def test_uses_exist_and_do_not_run_in_circles(by_label):
    settled: set[str] = set()
    waiting = dict(by_label)
    while waiting:
        ready = [label for label, d in waiting.items() if set(d.uses) <= settled]
        assert ready, f"circular or missing: { {label: d.uses for label, d in waiting.items()} }"
        settled.update(ready)
        for label in ready:
            del waiting[label]


def test_no_premise_stands_further_on(by_label):
    order = {label: place for place, label in enumerate(by_label)}
    late = {(each.label, used) for each in catalogue() for used in each.uses
            if order[used] >= order[each.label]}  # fmt: skip
    assert late == set()
    assert order["eq32"] + 1 == order["eq33"] == order["eq34"] - 1


def test_steady_sliding_is_proved(by_label):
    for derivation in (by_label[f"eq{number}"] for number in range(26, 49)):
        named = derivation.equation in (34, 37)
        weakest = "definition" if named else "proved-leading-order"
        assert STATUSES.index(derivation.status) <= STATUSES.index(weakest)
        assert (derivation.status == "definition") == named
    for label in ("eq41", "eq42", "eq44", "eq45", "eq46"):
        assert "F21-steady" in by_label[label].uses


THEOREMS = {
    *("F1", "F3", "F5", "F6", "F7", "scaled-load", "balance", "energy-any-shape"),
    *("circle-fixed", "circle-dead-weight", "eq33", "scaled-form", "F11-edges", "F14-energy"),
    *("F9", "F9-power", "F9-wedge", "F9-catenary", "F9-circle", "F9-two-slopes"),
    *("F15-runge-kutta", "F15-euler", "F15-sawtooth", "element-stability", "element-kink"),
    *("element-trapezoids", "element-bent"),
    *("F19-high", "F33", "F33-critical", "F33-critical-weight", "F33-free", "F33-forces"),
}
PROVED = {
    *("F1", "F3", "F5", "F6", "F7", "scaled-load", "balance", "energy-any-shape"),
    *(
        "circle-fixed",
        "circle-dead-weight",
        "eq33",
        "scaled-form",
        "F15-sawtooth",
        "element-trapezoids",
    ),
}
"""Those of them that rest on nothing but what they recall."""
LIMITS = {
    *("F2", "F4-low", "F4-high", "F16", "F10-turn", "F10-instant-limits", "F33-low", "F33-high"),
    *("element-mean-force", "element-fit", "element-orders", "element-arms"),
}
"""Results that are proved, and those of leading order."""
ARGUED = {
    *("F9-shapes", "F9-converse", "F10-gradual", "F17-concave", "F17-stored", "F17-interval"),
    *("F18-low", "F18-voigt", "F18-window", "F18-glassy", "F18-springpot", "F19-error-monotonic"),
    *("hurwitz", "F22-critical", "F22-flutter", "F23-surface", "F24-compression", "F25"),
    *("F27", "F27-close", "strips-rim", "strips-rule"),
    *("F28", "F29", "F30-field", "F32-series", "F32-ball-series"),
}
"""Results whose title rests on words, as their text says: there may be fewer, not more."""
BY_WORDS = 7
"""As many more use a result in words and recall no step of it: there may be fewer, not more."""


def test_only_what_is_recalled_is_a_premise(by_label):
    """Half the critical velocity, and twice the maximum, of what is typed and of what is recalled."""
    low, high, V_star = (getattr(asymptotics, name) for name in ("mu_low", "mu_high", "V_star"))
    for label, factor in (("typed", 2), ("recalled", 1)):
        proof = Proof(label, None, section="Trial", title="Trial", uses=("eq42", "eq45"))
        if label == "recalled":
            proof.asymptote("eq42", s.mu, low)
            proof.asymptote("eq45", s.mu, high)
            gap = low - high
        else:
            gap = factor * asymptotics.low_coefficient - asymptotics.high_coefficient
        proof.define(s.V, V_star, "where they meet")
        if label == "recalled":
            with pytest.raises(StepError, match="it is no root"):
                proof.root(gap, V_star, asymptotics.critical_fixed / 2, "half of it")
        proof.root(gap, V_star, asymptotics.critical_fixed / factor, "their crossing")
        assert proof.done().status == ("proved" if label == "recalled" else "argued")
    proof = Proof("twice", None, section="Trial", title="Trial", uses=("F3-values",))
    proof.recall("F3-values", s.mu_peak)
    stiffness = (s.mu_peak / s.mu_max) ** 3 * s.W / s.R**2
    equation = s.mu_max * sp.cbrt(s.K * s.R**2 / s.W) - s.mu_peak
    with pytest.raises(StepError, match="it is no root"):
        proof.root(equation, s.K, 8 * stiffness, "of twice the maximum")
    proof.root(equation, s.K, stiffness, "the stiffness")
    assert proof.done().status == "proved"
    for label in ("eq47", "eq48", "F5", "F26", "error-L1", "load", "friction"):
        assert {each.source for each in by_label[label].steps} >= set(by_label[label].uses)


RECALLED = {
    "wedge-weight-peeling": ("wedge-peeling", s.w_n),
    "wedge-weight-peeled": ("wedge-peeled", s.w_n),
    "circle-dead-weight": ("circle-fixed", s.c_w),
    "F20-load": ("F20-strip", ball.strip_load(ball.y)),
    "F20": ("F20-strip", ball.strip_friction(ball.y)),
    "F20-energy": ("F20-strip", ball.strip_loss(ball.y)),
    "F17-limits": ("F17-load", s.arm_load),
    "F17-kelvin-voigt": ("F1", s.w),
    "F18-low": ("F17", s.arm_work),
    "F18-high": ("F17-edge", s.edge_pressure),
    "F17-growth": ("F17-concave", s.a),
    "F17-parts": ("F17-forces", relaxation.LOADED),
    "F17-sign": ("F17-parts", s.F_x),
    "F17-stored": ("F17-energy", s.arm_lost),
    "F17-surface": ("F17-edge", s.edge_pressure),
    "F18-window": ("F18-voigt", s.voigt_error),
    "F18-window-weight": ("error-L2-dead-weight", (1 + s.e_l2_weight) ** 2),
    "F27-slope": ("F17-forces", relaxation.WORKED),
    "F27-steepest": ("F27-slope", s.force_slope),
}
"""Records, and what they recall of another."""


def refused(label):
    """Derive a record again, and return why it is refused."""
    entry = next(
        each for chapter in CHAPTERS for each in chapter.result.entries if each.label == label
    )
    with pytest.raises(StepError) as found:
        entry.derive("Trial")
    return str(found.value)


@pytest.mark.parametrize("label", RECALLED)
def test_half_of_what_is_recalled_is_refused(by_label, label, monkeypatch):
    source, name = RECALLED[label]
    known = book._finished[source]
    last = [sides for sides in known.exact if sides[0] == name][-1]
    half = (last[0], last[1] / 2)
    exact = {half if sides == last else sides: fact for sides, fact in known.exact.items()}
    monkeypatch.setitem(book._finished, source, replace(known, exact=exact, result=half))
    assert "another result" not in refused(label)


def test_half_of_a_recalled_asymptote_is_refused(by_label, monkeypatch):
    for label, source in (
        ("circle-fixed", "circle-shape"),
        ("eq45", "eq44"),
        ("F18-high", "F17-limits"),
    ):
        known = book._finished[source]
        leading = {(one, other / 2): fact for (one, other), fact in known.leading.items()}
        monkeypatch.setitem(book._finished, source, replace(known, leading=leading))
        assert "another result" not in refused(label)


def test_all_places_are_put_in_at_once(by_label):
    source = Proof("square", None, section="Trial", title="Trial")
    a, b = sp.symbols("a b", positive=True)
    source.equal((a + 2 * b) ** 2, a**2 + 4 * a * b + 4 * b**2, "multiplied out")
    source.done()
    proof = Proof("exchanged", None, section="Trial", title="Trial")
    proof.recall("square", at={a: b, b: a})
    assert proof._steps[-1].claim.lhs == (b + 2 * a) ** 2


def test_the_theorems_are_proved(by_label):
    weak = ("definition", "proved", "proved-leading-order")
    by_words = {
        label
        for label, each in by_label.items()
        if set(each.uses) - {step.source for step in each.steps}
    }
    argued = ARGUED | by_words
    assert len(by_words) <= BY_WORDS
    assert {label for label, each in by_label.items() if each.status not in weak} == argued
    assert {label for label, each in by_label.items() if "Argued, not" in each.text} == argued
    assert {step.status for each in by_label.values() for step in each.steps} == set(weak)
    assert set(by_label) >= THEOREMS | LIMITS
    assert {label for label in THEOREMS - argued if by_label[label].status != "proved"} == set()
    assert {by_label[label].status for label in LIMITS - argued} == {"proved-leading-order"}
    assert THEOREMS - argued >= PROVED
    transient = [each for each in by_label.values() if each.section.startswith("Transient")]
    groups = {"scaled", "F8", "F9", "F10", "F11", "F12", "F13", "F14"}
    assert {each.label.split("-")[0] for each in transient} == groups
    springs = [each for label, each in by_label.items() if label.startswith("F22")]
    assert len(springs) == 13
    assert {each.status for each in springs if each.label not in argued} <= {"proved", "definition"}
    (root,) = (step for step in by_label["F22-soft"].steps if "changes its sign" in step.reason)
    assert root.domain == "0 < q < 1"


def test_every_record_has_steps_and_balanced_text(by_label):
    for derivation in catalogue():
        assert derivation.latex
        assert derivation.latex in {step.latex for step in derivation.steps}
        texts = [derivation.title, derivation.text, *(step.reason for step in derivation.steps)]
        assert all(text.count("$") % 2 == 0 for text in texts)
        maths = [derivation.latex, *(step.latex for step in derivation.steps)]
        assert all(math.count("{") == math.count("}") and "$" not in math for math in maths)


class Contact:
    """Load and friction of steady sliding by quadrature of the elements' law, with 50 digits."""

    def __init__(self, ratio):
        """Take l_r/a of a scene whose other parameters are fixed."""
        self.R, self.K, self.C, self.delta = (mp.mpf(SCENE[x]) for x in (s.R, s.K, s.C, s.delta))
        self.a = mp.sqrt(2 * self.R * self.delta)
        self.V = ratio * self.a * self.K / self.C
        self.x_te = mp.findroot(self.pressure, (0, self.a), solver="anderson", tol=1e-90)
        self.W = mp.quad(self.pressure, [-self.a, self.x_te])
        self.F = mp.quad(lambda x: -x / self.R * self.pressure(x), [-self.a, self.x_te])
        self.mu = self.F / self.W

    def pressure(self, x):
        u, rate = self.delta - x**2 / (2 * self.R), -x / self.R * self.V
        return self.K * u + self.C * rate

    def value(self, expr):
        """Evaluate an expression in the quantities of this contact."""
        names = {
            s.R: self.R, s.K: self.K, s.C: self.C, s.delta: self.delta, s.V: self.V,
            s.W: self.W, s.a: self.a, s.q: self.x_te / self.a,
        }  # fmt: skip
        point = {symbol: sp.Float(value, DIGITS) for symbol, value in names.items()}
        return mp.mpf(str(sp.N(sp.sympify(expr).subs(point), DIGITS)))


@pytest.mark.parametrize("ratio", ["0.001", "0.4", "1", "4.08", "300"])
def test_exact_forms_against_quadrature(ratio):
    contact = Contact(mp.mpf(ratio))
    for expr, expected in (
        (steady.load, contact.W),
        (steady.friction, contact.F),
        (steady.friction_coefficient, contact.mu),
        (steady.trailing_edge.subs(s.l_r, contact.value(s.C * s.V / s.K)), contact.x_te),
    ):
        assert mp.almosteq(contact.value(expr), expected, rel_eps=mp.mpf("1e-40"))


LOW, HIGH = "1e-6", "1e6"
THREE_HALVES = sp.Rational(3, 2)
critical = (asymptotics.critical_dead_weight / s.V) ** THREE_HALVES
low = s.C * s.V / (s.K * s.a)
ORDERS = [
    ("x_te", s.a, LOW, low, -1, 1),
    ("x_te", s.a**2 * s.K / (2 * s.C * s.V), HIGH, 1 / low, "-1/4", 2),
    ("W", asymptotics.low_load, LOW, low, "3/4", 2),
    ("F", asymptotics.low_friction, LOW, low, "-3/4", 1),
    ("mu", asymptotics.low_coefficient, LOW, low, "-3/4", 1),
    ("W", asymptotics.high_load, HIGH, 1 / low, "2/3", 1),
    ("F", asymptotics.high_friction, HIGH, 1 / low, "3/8", 1),
    ("mu", asymptotics.high_coefficient, HIGH, 1 / low, "-7/24", 1),
    ("mu", asymptotics.high_coefficient_dead_weight, HIGH, critical, "-15/16", 1),
    ("delta", s.W / (s.C * s.V), HIGH, critical, -1, 1),
]
"""Quantity, asymptote, where, small parameter, and what the derivation prints: c and k."""


@pytest.mark.parametrize(("name", "leading", "ratio", "small", "c", "k"), ORDERS)
def test_remainders_have_the_coefficient_and_order_that_are_printed(
    name, leading, ratio, small, c, k
):
    contact = Contact(mp.mpf(ratio))
    remainder = getattr(contact, name) / contact.value(leading) - 1
    found = remainder / contact.value(small) ** k
    assert float(found) == pytest.approx(float(sp.Rational(c)), rel=2e-5)


def test_printed_remainders(by_label):
    printed = {
        "eq30": r"1 - \frac{l_{\mathrm{r}}}{a}",
        "eq31": r"1 - \frac{a^{2}}{4 l_{\mathrm{r}}^{2}}",
        "eq40": r"1 + \frac{3 l_{\mathrm{r}}^{2}}{4 a^{2}}",
        "eq41": r"1 - \frac{3 l_{\mathrm{r}}}{4 a}",
        "eq42": r"1 - \frac{3 l_{\mathrm{r}}}{4 a}",
        "eq43": r"1 + \frac{2 a}{3 l_{\mathrm{r}}}",
        "eq44": r"1 + \frac{3 a}{8 l_{\mathrm{r}}}",
        "eq45": r"1 - \frac{7 a}{24 l_{\mathrm{r}}}",
        "eq46": r"1 - \frac{15}{16} \left(\frac{V^{*}}{V}\right)^{3/2}",
        "eq49": r"1 - \left(\frac{V^{*}}{V}\right)^{3/2}",
    }
    for label, series in printed.items():
        assert series in by_label[label].latex


def test_a_sum_begins_with_a_positive_term(by_label):
    """W - C V delta, not -C V delta + W; only what was written by hand may differ."""
    opening = re.compile(r"- [^+(]*(?<![\^{(]) \+ ")
    shown = {step.right for each in by_label.values() for step in each.steps}
    assert {right for right in shown if opening.match(right) and "{" not in right} == set()
    steps = {step.right for step in by_label["F21-steady"].steps}
    assert r"\frac{l_{\mathrm{r}} \left(W - C V \delta\right)}{R}" in steps
    assert (
        by_label["critical-dead-weight"].latex
        == r"V^{*} = \frac{\alpha^{2/3} \sqrt[3]{K^{2} R W}}{C}"
    )


def test_what_is_printed_is_what_was_claimed(by_label):
    """The print of each claim, read back by a parser, is the claim again."""
    claims = [step.claim for each in by_label.values() for step in each.steps if step.claim]
    sides = {side for each in claims for side in (each.lhs, each.rhs) if isinstance(side, sp.Expr)}
    unread = 0
    for side in sorted(sides, key=sp.default_sort_key):
        letters = side.atoms(
            sp.Symbol
        )  # also those of a derivative that its inner side does not show
        names = names_in(side, *letters, tex_of=TEX) | {r"\pi": sp.pi, **CONSTANTS}
        try:
            found = read(doprint(side), names)
        except ValueError:
            unread += 1
            continue
        if found != side:
            plain = [
                each.replace(sp.UnevaluatedExpr, lambda inner: inner) for each in (found, side)
            ]
            if any(each.has(sp.Integral) for each in plain):
                assert sp.expand(sp.numer(sp.together(plain[0] - plain[1]))) == 0, side
            else:
                assert sp.simplify(difference(*(each.doit() for each in plain))) == 0, side
    assert len(sides) > 1800
    assert (
        unread < 80
    )  # sums, matrices, places of several letters, functions that the parser does not know


def test_asymptotes_meet_at_the_critical_velocities():
    contact = Contact(mp.mpf("0.7"))
    for critical_velocity, high in (
        (asymptotics.critical_fixed, asymptotics.high_coefficient),
        (asymptotics.critical_dead_weight, asymptotics.high_coefficient_dead_weight),
    ):
        contact.V = contact.value(critical_velocity)
        one, other = contact.value(asymptotics.low_coefficient), contact.value(high)
        assert mp.almosteq(one, other, rel_eps=mp.mpf("1e-45"))


@pytest.mark.parametrize(
    "products", [groups.fixed_groups, groups.dead_weight_groups, groups.transient_groups]
)
def test_groups_do_not_change_with_the_units(products):
    """Rescale the units of force, of both lengths and of time by unrelated factors."""
    factors = dict(zip(groups.BASE, (3, 7, 11, 5), strict=True))
    scaled = {q: q * dimension.subs(factors) for q, dimension in groups.DIMENSIONS.items()}
    for product in products.values():
        ratio = product.subs(scaled, simultaneous=True) / product
        assert sp.N(ratio, 30) == pytest.approx(1, rel=1e-25)


def test_one_group_of_the_operation_but_two_with_one_length():
    operation = (s.R, s.K, s.tau, s.V, s.delta)
    matrix = groups.dimension_matrix(operation)
    assert len(matrix.nullspace()) == 1
    assert len(groups.isotropic(matrix).nullspace()) == 2


def test_table_1_against_floats(by_label):
    values = {symbol: float(value) for _, symbol, value, _ in by_label["table1"].table.rows}
    weight, depth = 9806.65, 300.177e-6
    drive = 0.01 / (2 * 0.01 * 300e-6) ** 0.5
    q = (1 + drive**2) ** 0.5 - drive
    expected = {
        "$R$": 10, "$N$": 200,
        r"$a$ (28)": (2 * 10 * 0.3) ** 0.5,
        r"$l_{\mathrm{r}}$ (29)": 100 * 0.1,
        "$W = M g$": weight / 1000,
        r"$\delta_0$": depth * 1e6,
        r"$V \tau (K/R W)^{1/3}$": 0.01 * (1e10 / (0.01 * weight)) ** (1 / 3),
        r"$\lambda = V \tau/a_0$": 0.01 / (2 * 0.01 * depth) ** 0.5,
        r"$\varepsilon = \delta_0/(g \tau^2)$": 1000 * depth / (weight * 0.1**2),
        r"$\mu$ (37)": (2 * 10 * 0.3) ** 0.5 / 10
        * (1 - q) * (q**2 - q + 4) / (2 * (q**2 - 2 * q + 3)),
    }  # fmt: skip
    for symbol, value in expected.items():
        assert values[symbol] == pytest.approx(value, rel=6e-6)
    static = tables.static_depth.subs(tables.STANDARD)
    assert 4 / 3 * 1e10 * (0.02 * float(static)) ** 0.5 * float(static) == pytest.approx(weight)


def test_table_2_refers_to_the_equations(by_label):
    rows = by_label["table2"].table.rows
    numbers = [[cell.split("(")[-1].rstrip(")") for cell in row[1:]] for row in rows]
    assert numbers == [["47", "48"], ["42", "42"], ["45", "46"]]
