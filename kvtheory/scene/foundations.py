"""Foundations: rows of independent viscoelastic elements, each defined by its relaxation function G(t).

An element compressed by u exerts the pressure p(t) = int G(t - t') du/dt' dt'. Every foundation has its
`kind`, the relaxed `stiffness` K, and beside this spring the `damping` C of a damper, `arms`, or a
`springpot` of an `order`. From these follow its `law`, which decides what is known of it; the `slow_damping`
int (G - K) dt, which governs slow sliding; and the `retardation_time` int (G - K) dt/K.
"""

import copy
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import KW_ONLY, dataclass, fields, replace
from numbers import Real
from typing import Any, ClassVar

import numpy as np

from kvtheory.export import above
from kvtheory.scene.layer import (
    REST,
    THIN_WAY,
    WAYS,
    layer_stiffness,
    not_at_rest,
    rest_stiffness,
)
from kvtheory.scene.mistakes import Problems, SceneError, mistake, nearest
from kvtheory.scene.quantities import (
    Derived,
    Part,
    Quantity,
    Value,
    as_given,
    convert,
    derive,
    is_derived,
    missing,
    quantities,
    quantity,
    validate,
    written_sample,
)
from kvtheory.scene.units import to_si

LAYER = ("modulus", "thickness", "poisson_ratio")
MOST_ARMS = 100
PAIRS = 'pairs of stiffness and relaxation time, such as ["30 GN/m^3", "10 ms"]'
OF_LAYER = 'pairs of modulus and relaxation time, such as ["30 MPa", "10 ms"]'
LOWEST_ORDER = 1e-8
"""Lowest order of a springpot: its loss, which is proportional to it, would drown in rounding."""
DISTINCT = 1e-6
"""Relative difference of relaxation times below which two arms count as the same."""
TIMES = "retardation_time", "relaxation_time", "damping"
"""The quantities that temperature shifts; a damper is a stiffness times a time."""
THERMAL = "temperature", "reference_temperature", "activation_energy", "wlf", "shift_factors"
GAS_CONSTANT = 8.31446261815324
"""R, in J/(mol K), exact."""
EXTRAPOLATED = (
    "outside the frequencies at which the foundation is known, so that its series extrapolates"
)
BEYOND = "outside the temperatures at which its shift is known, so that a_T extrapolates"
NEAR, GLASS = 2.0, 30.0
"""Distance in K by which a temperature may be outside, and the least one of the glass transition, above which
WLF's law holds, from its pole."""
BARELY = 1.001
"""Factor by which a frequency may be outside the measured ones."""
MEASURED_RANGES = (
    ("lowest_frequency", "highest_frequency"),
    ("lowest_temperature", "highest_temperature"),
)
MEASURED = sum(MEASURED_RANGES, ())
DAMPER, ARMS, SPRINGPOT = "kelvin-voigt", "generalized-maxwell", "fractional-kelvin-voigt"
DAMPED = f"{ARMS} with damping"
LAWS = DAMPER, ARMS, DAMPED, SPRINGPOT
"""The laws of the table of capabilities: what is beside the spring, a damper, arms, both, or a springpot."""
NO_DAMPER = (
    "a layer has arms alone, as its damping would not follow its thickness; expected foundation.stiffness "
    "instead of modulus, thickness and poisson_ratio, or an arm with a short relaxation time"
)
FACTORS = 'pairs of temperature and log10 a_T as measured, such as ["0 degC", 2.155], that of T_ref with 0'
SAME_TEMPERATURE = 0.01
"""Difference in K up to which a temperature of shift factors is the reference temperature."""
RELATIVE = (
    ". Moduli g_i of Abaqus or ANSYS are relative to the instantaneous modulus E_0: the relaxed one is "
    "E_0 (1 - sum g_i), and that of an arm is g_i E_0; `foundation` reads such a card"
)
WLF_PAIR = 'C_1 and C_2, such as ["17.44", "51.6 K"]'


def extrapolates(foundation: "AnyFoundation", velocity: Any, contact_length: Any) -> str:
    """Return a note if V/c, or V a_T/c, is outside the measured frequencies, or an empty text; or arrays."""
    low, high = foundation.lowest_frequency, foundation.highest_frequency
    if low is None:
        return ""
    f = np.asarray(np.abs(velocity) / np.abs(contact_length) * foundation.shift_factor)
    outside = (f > 0.0) & ((f < low / BARELY) | (f > high * BARELY))
    if not outside.any():
        return ""
    value = f"= {f:.3g} Hz is" if f.ndim == 0 else f"is, in {outside.sum()} of {f.size} scenes,"
    shifted = " a_T" if foundation.temperature is not None else ""
    return f"V{shifted}/c {value} {EXTRAPOLATED} ({np.min(low):.3g} to {np.max(high):.3g} Hz)."


def beyond(foundation: "AnyFoundation") -> str:
    """Return a note if a temperature is not among those at which its shift is known, or an empty text."""
    T, wlf = foundation.temperature, foundation.wlf
    low, high = foundation.lowest_temperature, foundation.highest_temperature
    if wlf is not None and low is None:
        low, high = foundation.reference_temperature - wlf.c_2 + GLASS, np.inf
    if T is None or low is None:
        return ""
    known = f"{np.min(low):.5g} to {np.max(high):.5g} K"
    outside = np.asarray((low > T + NEAR) | (high < T - NEAR))
    value = f"{T:.5g} K" if outside.ndim == 0 else f"in {outside.sum()} of {outside.size} scenes"
    return f"foundation.temperature, {value}, is {BEYOND} ({known})." if outside.any() else ""


@dataclass(frozen=True, eq=False)
class WLF(Part):
    """The law of Williams, Landel and Ferry: log10 a_T = -C_1 (T - T_ref)/(C_2 + T - T_ref)."""

    c_1: Value = quantity("1", "C_1 of the WLF law, for the decadic logarithm")
    c_2: Value = quantity("K", "C_2 of the WLF law", difference=True)

    def __post_init__(self) -> None:
        validate(self, "foundation.wlf")


@dataclass(frozen=True, eq=False)
class _Relaxed(Part):
    """What all foundations have in common: a stiffness, or the layer it follows from; and temperature.

    The stiffness of a layer is, by `stiffness_from`, that of a "thin" one, or by default that of its contact
    at "rest", which depends on indenter and support: only the foundation of a scene has it.

    At a `temperature` every time of the foundation is a_T times that at the `reference_temperature`
    (`shift_factor`); the moduli stay (fact F25). Times are given at the reference temperature; the attributes
    are those at the temperature. `shift_factors`, pairs of temperature and log10 a_T as measured, hold
    exactly; the law goes through them, by adding to it what it misses, linear in between.
    """

    stiffness: Value = quantity(
        "N/m^3", "K, stiffness of the foundation per unit area",
        default=None, needed=True, instead="modulus", excludes=(*LAYER, "stiffness_from"),
    )  # fmt: skip
    _: KW_ONLY
    modulus: Value = quantity(
        "N/m^2", "E, Young's modulus of a bonded layer, instead of the stiffness",
        default=None, beside=("thickness", "poisson_ratio"), excludes=("stiffness",),
    )  # fmt: skip
    thickness: Value = quantity(
        "m", "h, thickness of the layer; inf is a half-space, under a ball", default=None, infinite=True,
        beside=("modulus", "poisson_ratio"), excludes=("stiffness",),
    )  # fmt: skip
    poisson_ratio: Value = quantity(
        "1", "nu, Poisson's ratio of the layer", default=None, exclusive=False, maximum=0.5,
        beside=("modulus", "thickness"), excludes=("stiffness",),
    )  # fmt: skip
    temperature: Value = quantity(
        "K", "T, temperature of the foundation; the reference temperature if not given",
        default=None, beside=("reference_temperature",),
    )  # fmt: skip
    reference_temperature: Value = quantity(
        "K", "T_ref, temperature at which the times of the foundation were measured",
        default=None, beside=("wlf",),
    )  # fmt: skip
    activation_energy: Value = quantity(
        "J/mol", "E_a of Arrhenius' law, ln a_T = (E_a/R) (1/T - 1/T_ref), instead of wlf",
        default=None, beside=("reference_temperature",), excludes=("wlf",),
    )  # fmt: skip
    lowest_frequency: Value = quantity(
        "1/s", "lowest frequency at which the foundation was measured, at the reference temperature",
        default=None, beside=("highest_frequency",),
    )  # fmt: skip
    highest_frequency: Value = quantity(
        "1/s", "highest frequency at which it was measured; V/c outside is noted, c the contact length",
        default=None, beside=("lowest_frequency",),
    )  # fmt: skip
    lowest_temperature: Value = quantity(
        "K", "lowest temperature at which the shift of its times was measured",
        default=None, beside=("highest_temperature",),
    )  # fmt: skip
    highest_temperature: Value = quantity(
        "K", "highest temperature at which the shift was measured; a temperature outside is noted",
        default=None, beside=("lowest_temperature",),
    )  # fmt: skip
    wlf: WLF | None = None
    stiffness_from: str | None = None
    shift_factors: Any = None
    kind: ClassVar[str]
    arms: ClassVar[Any] = ()
    damping: ClassVar[Any] = 0.0
    springpot: ClassVar[bool] = False
    order = 1.0  # not annotated, which would decide its place among the fields of a springpot

    def __post_init__(self) -> None:
        problems = Problems()
        held: list[Any] = [self, *self._read_arms(problems)]
        lawless = self.wlf is None and self.activation_energy is None
        if self.modulus is None and is_derived(self.stiffness):
            object.__setattr__(self, "stiffness", +self.stiffness)  # derived for another foundation
        times = [(part, name) for part in held for name in TIMES if name in vars(part)]
        for part, name in times:  # without a law, a time that was shifted stays as it is
            time = getattr(part, name)
            if is_derived(time) and time.given is not None:
                object.__setattr__(part, name, +time if lawless else as_given(time))
        with problems.catching("foundation", self):
            validate(self, "foundation")
            if self.modulus is not None and np.any(damping := vars(self).get("damping")):
                raise mistake("foundation.damping", damping, NO_DAMPER)
        self._read_law(problems)
        self._read_way(problems)
        problems.report()
        self._order_ranges()
        if self.stiffness_from == THIN_WAY:
            self._stiffen(layer_stiffness(self.modulus, self.thickness, self.poisson_ratio))
        if not lawless:
            self._shift((part, name) for part, name in times if getattr(part, name) is not None)
        if vars(self).get("damping", 0.0) is None:
            object.__setattr__(self, "damping", Derived(0.0))
        if not lawless or len(held) > 1:
            self.mark(part for _, part in self.nested())

    def _read_law(self, problems: Problems) -> None:
        """Convert the law that shifts times, and report what it lacks."""
        if self.wlf is not None:
            with problems.catching("foundation.wlf", self.wlf):
                if not isinstance(self.wlf, WLF) and not _is_pair(self.wlf):
                    raise ValueError(f"expected {WLF_PAIR}")
                law = self.wlf if isinstance(self.wlf, WLF) else WLF(*self.wlf)
                object.__setattr__(self, "wlf", law)
        given = [key for key in THERMAL[:2] if getattr(self, key) is not None]
        if self.wlf is not None and self.activation_energy is not None:
            problems.append("foundation.wlf: cannot be given beside foundation.activation_energy")
        elif self.wlf is not None and not given:
            problems.append(missing("foundation", "reference_temperature", REFERENCE))
        elif self.wlf is None and self.activation_energy is None and given:
            message = f"needs a law that shifts times; expected foundation.wlf = {WLF_PAIR}"
            problems.append(f"foundation.{given[0]}: {message}, or foundation.activation_energy")
        if self.shift_factors is not None:
            with problems.catching("foundation.shift_factors", self.shift_factors):
                object.__setattr__(self, "shift_factors", self._read_factors())

    def _read_factors(self) -> tuple[tuple[float, float], ...]:
        """Return the measured shift factors by temperature (K), or raise."""
        given, T_ref = self.shift_factors, self.reference_temperature
        listed = isinstance(given, Sequence) and not isinstance(given, str)
        if not listed or not given or not all(map(_is_pair, given)):
            raise ValueError(f"expected {FACTORS}")
        pairs = sorted((to_si(T, "K"), to_si(log, "1")) for T, log in given)
        T, log = np.array(pairs).T
        if T_ref is None or (self.wlf is None and self.activation_energy is None):
            message = "needs foundation.reference_temperature and a law, wlf or activation_energy"
            raise ValueError(message)
        if not np.isfinite(pairs).all() or T[0] <= 0.0 or (np.diff(T) <= 0.0).any():
            raise ValueError(f"expected finite, different temperatures above 0 K; {FACTORS}")
        place = np.abs(T - np.min(T_ref)).argmin()
        if abs(T[place] - np.min(T_ref)) > SAME_TEMPERATURE or log[place] != 0.0:
            message = "expected log10 a_T = 0 at foundation.reference_temperature"
            raise ValueError(f"{message}; {FACTORS}")
        return tuple(pairs)

    def _read_way(self, problems: Problems) -> None:
        """Take the way to the stiffness of a layer, at rest if none is given, and report a wrong one."""
        key, way, nu = "foundation.stiffness_from", self.stiffness_from, self.poisson_ratio
        if self.modulus is None:
            if way is not None:
                problems.add(key, way, f"needs a layer; expected {', '.join(LAYER)} beside it")
            return
        object.__setattr__(self, "stiffness_from", way := REST if way is None else way)
        if way not in WAYS:
            problems.add(key, way, nearest(str(way), WAYS))
        elif way == THIN_WAY and not problems and np.any(np.isinf(self.thickness)):
            problems.add(key, way, f'a half-space is not thin; expected "{REST}"')
        elif way == THIN_WAY and not problems and np.any(np.equal(nu, 0.5)):
            message = f'no K describes a thin incompressible layer; expected "{REST}"'
            problems.add(key, way, f"{message} beside foundation.poisson_ratio = 0.5")

    def _stiffen(self, stiffness: Any) -> None:
        """Derive the stiffness of a layer, and those of its arms, which are as their moduli."""
        derive(self, "foundation", "stiffness", stiffness, "the layer")
        for i, arm in enumerate(vars(self).get("arms", ())):
            own = stiffness * (arm.modulus / self.modulus)
            derive(arm, f"foundation.arms[{i}]", "stiffness", own, "the layer")

    @property
    def elements(self) -> Any:
        """The foundation by its stiffness: of a layer in a scene, the independent elements that it gives."""
        if self.modulus is None:
            return self
        given: dict[str, Any] = dict.fromkeys((*LAYER, "stiffness_from"))
        given["stiffness"] = +self.stiffness
        if "arms" in vars(self):
            given["arms"] = [
                replace(arm, stiffness=+arm.stiffness, modulus=None) for arm in self.arms
            ]
        return replace(self, **given)

    def under(self, indenter: Any, support: Any) -> Any:
        """Return the foundation under an indenter: of a layer, with the K of its contact at rest if known."""
        if self.stiffness_from != REST:
            return self
        found = copy.copy(self)
        if "arms" in vars(self):
            object.__setattr__(found, "arms", tuple(map(copy.copy, self.arms)))
        if not_at_rest(indenter):
            for part in (found, *found.arms):
                object.__setattr__(part, "stiffness", None)
        else:
            found._stiffen(rest_stiffness(self, indenter, support))
        found.mark(part for _, part in found.nested())
        return found

    def _order_ranges(self) -> None:
        """Raise `SceneError` if a measured range is empty."""
        for least, most in MEASURED_RANGES:
            low, high = getattr(self, least), getattr(self, most)
            if low is not None and np.any(low >= high):
                raise mistake(f"foundation.{most}", high, f"expected above foundation.{least}")

    def _read_arms(self, problems: Problems) -> Sequence["Arm"]:
        """Return the arms that are given as pairs, converted; none where they follow from quantities."""
        return ()

    @property
    def law(self) -> str:
        """Its law in the table of capabilities: by what is beside the spring, whatever the kind."""
        if self.springpot or not self.arms:
            return SPRINGPOT if self.springpot else DAMPER
        return DAMPED if np.any(self.damping) else ARMS

    @property
    def own(self) -> dict[str, Quantity]:
        """The quantities that foundations of other kinds need not have."""
        return {n: spec for n, spec in quantities(self).items() if n not in quantities(_Relaxed)}

    @property
    def slow_damping(self) -> Value:
        """C + sum K_i tau_i, in N s/m^3: that of the equivalent Kelvin-Voigt foundation in slow sliding."""
        if self.stiffness is None:
            return None
        return sum((arm.stiffness * arm.relaxation_time for arm in self.arms), +self.damping)

    @property
    def retardation_time(self) -> Value:
        """(C + sum K_i tau_i)/K, in s; of a layer E and E_i instead."""
        if self.stiffness is not None:
            return self.slow_damping / self.stiffness
        if self.modulus is None:
            return None
        return sum(arm.modulus * arm.relaxation_time for arm in self.arms) / self.modulus

    @property
    def shift_factor(self) -> Value:
        """a_T, by which temperature multiplies every time of the foundation; 1 without a law."""
        T, T_ref = self.temperature, self.reference_temperature
        if T is None or T_ref is None:
            return 1.0
        with np.errstate(all="ignore"):  # what leaves double precision is reported by the keys
            if self.shift_factors is None and self.wlf is None:
                return np.exp(self.activation_energy / GAS_CONSTANT * (T_ref - T) / T / T_ref)[()]
            log = self._law(T)
            if self.shift_factors is not None:
                measured, known = np.array(self.shift_factors).T
                log = log + np.interp(T, measured, known - self._law(measured))
            return np.power(10.0, log)[()]

    def _law(self, T: Any) -> Any:
        """Return log10 a_T of the law alone."""
        own = (self.activation_energy,) if self.wlf is None else (self.wlf.c_1, self.wlf.c_2)
        return log_shift(T, self.reference_temperature, *own)

    def _shift(self, times: Iterable[tuple[Any, str]]) -> None:
        """Multiply every time by a_T, and keep the given value in `Derived.given`."""
        T, key = self.temperature, "foundation.temperature"
        shown = f"{T:.10g} K" if isinstance(T, float) else T
        law = "activation_energy" if self.wlf is None else "wlf"
        if T is not None and self.wlf is not None:
            pole = self.reference_temperature - self.wlf.c_2
            if np.any(pole >= T):
                message = f"expected above T_ref - C_2 = {np.max(pole):g} K"
                message += ", the pole of the WLF law"
                raise mistake(key, shown, message)
        a_T = self.shift_factor
        for part, name in times:
            given = getattr(part, name)
            with np.errstate(all="ignore"):
                shifted = given * a_T
            if not quantities(part)[name].admits(shifted):
                message = f"shifts times by a_T = {np.ravel(a_T)[0]:g}, beyond double precision; check {key}"
                keys = f"foundation.reference_temperature and foundation.{law}"
                raise mistake(key, shown, f"{message}, {keys}")
            derive(part, "foundation", name, shifted, key, given)

    def plain(self, factor: float = 1.0) -> Any:
        """Return the foundation at its temperature, without layer and law, `factor` times as stiff."""
        own: dict[str, Any] = {
            name: (factor if spec.unit.startswith("N") else 1.0) * +getattr(self, name)
            for name, spec in self.own.items()
        }
        if any(field.name == "arms" for field in fields(self)):
            own["arms"] = [(factor * arm.stiffness, +arm.relaxation_time) for arm in self.arms]
        return type(self)(factor * self.stiffness, **own)

    def mapped(self, function: Any) -> Any:
        """Return a copy with a function applied to every array; its times are those at its temperature."""
        found = super().mapped(function)
        vars(found).update(dict.fromkeys(THERMAL))
        return found


REFERENCE = quantities(_Relaxed)["reference_temperature"]


def log_shift(T: Any, reference: Any, *constants: Any) -> Any:
    """Return log10 a_T by Arrhenius' law, of E_a (J/mol), or by WLF's, of C_1 and C_2 (K); T in K."""
    if len(constants) == 1:
        return constants[0] / GAS_CONSTANT * (reference - T) / T / reference / math.log(10.0)
    c_1, c_2 = constants
    return -c_1 * (T - reference) / (c_2 + T - reference)


def _is_pair(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, str) and len(value) == 2


@dataclass(frozen=True, eq=False)
class Foundation(_Relaxed):
    """Independent Kelvin-Voigt elements: G = K + C delta(t), C = K tau, all per unit area.

    A bonded layer is given by `modulus`, `thickness` and `poisson_ratio` instead of `stiffness`, which then
    follows from its contact at rest, in a scene, or, by `stiffness_from`, from a thin layer. A `temperature`
    shifts the retardation time from that at the `reference_temperature`, by `wlf` or an `activation_energy`.

    >>> layer = {"modulus": "5 MPa", "thickness": "2 mm", "poisson_ratio": 0.45, "retardation_time": 0.1}
    >>> Foundation(**layer).stiffness, round(Foundation(**layer, stiffness_from="thin").stiffness / 1e9, 4)
    (None, 9.4828)
    >>> warm = Foundation("10 GN/m^3", "100 ms", temperature="60 degC",
    ...                   reference_temperature="23 degC", wlf=["17.44", "51.6 K"])
    >>> print(f"{warm.shift_factor:.4g} {warm.retardation_time:.4g}")
    5.211e-08 5.211e-09
    """

    kind: ClassVar[str] = DAMPER
    retardation_time: Value = quantity(
        "s", "tau = C/K, retardation time of the foundation (Eq. 22)", default=None, needed=True
    )

    @property
    def damping(self) -> Value:
        """C = K tau, damping per unit area, in N s/m^3 (Eq. 22)."""
        return None if self.stiffness is None else self.stiffness * self.retardation_time


@dataclass(frozen=True, eq=False)
class Arm(Part):
    """A Maxwell arm, spring and damper in series: K_i e^(-t/tau_i), a term of a Prony series.

    An arm of a layer has a `modulus`, from which its stiffness follows as that of the layer does.
    """

    stiffness: Value = quantity(
        "N/m^3", "K_i, stiffness of the arm per unit area",
        default=None, needed=True, instead="modulus", excludes=("modulus",),
    )  # fmt: skip
    relaxation_time: Value = quantity(
        "s", "tau_i, relaxation time of the arm", default=None, needed=True
    )
    _: KW_ONLY
    modulus: Value = quantity(
        "N/m^2", "E_i, modulus of the arm of a layer, instead of its stiffness",
        default=None, excludes=("stiffness",),
    )  # fmt: skip

    def __post_init__(self) -> None:
        time = self.relaxation_time
        validate(self, "arm")
        if as_given(time) is not time:  # the foundation undoes its shift, or keeps it
            object.__setattr__(self, "relaxation_time", time)


WIDEST = 1e30
"""Longest over shortest time in which a contact is passed, of a series from a function."""


def _share(rtol: float) -> float:
    if not (isinstance(rtol, Real) and 0.0 < rtol < 1.0):
        raise ValueError(f"`rtol` = {rtol!r}: expected a number above 0 and below 1")
    return rtol


def _si(name: str, value: Any, spec: Any) -> float:
    """Return an argument in SI, or raise the error that names it."""
    try:
        return convert(value, spec)
    except ValueError as error:
        raise mistake(name, value, str(error)) from None


def _range(over: Any) -> tuple[float, float]:
    """Return two times in s, the shortest and the longest."""
    spec = quantities(Arm)["relaxation_time"]
    if not _is_pair(over):
        raise ValueError(f"`over` = {over!r}: expected the shortest and the longest time")
    shortest, longest = (_si("`over`", each, spec) for each in over)
    if not 1.0 < longest / shortest <= WIDEST:
        raise ValueError(
            f"`over` = {over!r}: expected the shortest time first, then one that is longer, "
            f"by a factor of at most {WIDEST:g}"
        )
    return shortest, longest


@dataclass(frozen=True, eq=False)
class GeneralizedMaxwell(_Relaxed):
    """A spring in parallel with Maxwell arms and a damper: G = K + C delta(t) + sum K_i e^(-t/tau_i).

    `arms` are pairs of stiffness and relaxation time, one to a hundred, with different times; those of a
    layer are pairs of modulus and relaxation time. One arm is the standard linear solid (Zener). The
    `damping` C of the damper is zero if it is not given. A layer takes none: its modulus and arms follow the
    thickness, which a damping per unit area would not.

    >>> zener = GeneralizedMaxwell("10 GN/m^3", arms=[["30 GN/m^3", "10 ms"]])
    >>> zener.arms[0].relaxation_time, zener.damping, zener.slow_damping, zener.retardation_time
    (0.01, 0.0, 300000000.0, 0.03)
    """

    kind: ClassVar[str] = ARMS
    arms: tuple[Arm, ...] = ()  # type: ignore[misc]
    damping: Value = quantity(  # type: ignore[misc]
        "N*s/m^3", "C, damping per unit area of a damper beside the arms; 0 if not given",
        default=None, exclusive=False,
    )  # fmt: skip

    deviation: ClassVar[float] = 0.0
    """eps of fact F27, of a foundation from a relaxation function or a spectrum; 0 of arms as given, such as
    those of a foundation that `replace` has changed."""

    @property
    def friction_bound(self) -> float:
        """Most by which mu of a parabola under a load differs from that of the function, relative to it.

        At an equal length of the contact, loads differ by the factor r = (1 + eps)/(1 - eps) at most and
        friction forces by r^2; these grow with the load to the power 5/2 at most, so that mu, at an equal
        load, differs by r^(9/2) (fact F27).
        """
        return float(((1.0 + self.deviation) / (1.0 - self.deviation)) ** 4.5 - 1.0)

    @classmethod
    def from_relaxation(
        cls, G: Callable[[float], float], *, rtol: float = 0.01, over: Any, stiffness: Any = None
    ) -> "GeneralizedMaxwell":
        """Return the fewest arms for any relaxation function G(t), with a bound on the change of friction.

        `G` takes a time in s and returns N/m^3, its relaxed value included, which is G(inf) or `stiffness`.
        It has to fall with time, and may be infinite at t = 0. `over` are the shortest and the longest time
        in which a contact is passed, in s or with a unit. At an equal length of the contact, load and
        friction in steady sliding are within the factors 1 - eps and 1 + eps of those of G, eps =
        `deviation` <= `rtol` (fact F27), while c/V, c the contact length, is within `over`; outside, results
        have a note. Under a given load mu differs by `friction_bound` of it at most.

        Raises ValueError if `G` does not fall, or no series is within `rtol`.

        >>> from math import exp, inf
        >>> stretched = lambda t: 1e9 + 3e9 * exp(-((t / 0.01) ** 0.5))  # Kohlrausch, Williams and Watts
        >>> found = GeneralizedMaxwell.from_relaxation(stretched, rtol=0.1, over=("0.1 ms", "0.1 s"))
        >>> found.stiffness, found.deviation < 0.1, 5 <= len(found.arms) <= 12
        (1000000000.0, True, True)
        """
        fitting, over = above("fitting.relaxation"), _range(over)
        if stiffness is None:
            K = fitting.value_of("G", G, math.inf)
        else:
            K = _si("`stiffness`", stiffness, quantities(cls)["stiffness"])
        return cls._of(K, over, *fitting.arms_of(G, K, _share(rtol), over))

    @classmethod
    def from_spectrum(
        cls, stiffness: Any, H: Callable[[float], float], *, rtol: float = 0.01, over: Any
    ) -> "GeneralizedMaxwell":
        """Return the fewest arms for a spectrum H(tau) in N/m^3: G = K + int H e^(-t/tau) d ln tau.

        `stiffness` is K; for the rest see `from_relaxation`.

        >>> from math import exp, log
        >>> lognormal = lambda tau: 2e9 * exp(-0.5 * (log(tau / 1e-3) / 2.0) ** 2)
        >>> found = GeneralizedMaxwell.from_spectrum("1 GN/m^3", lognormal, rtol=0.1, over=(1e-4, 0.01))
        >>> found.deviation < 0.1
        True
        """
        K = _si("`stiffness`", stiffness, quantities(cls)["stiffness"])
        over = _range(over)
        return cls._of(
            K, over, *above("fitting.relaxation").arms_of_spectrum(H, _share(rtol), over)
        )

    @classmethod
    def _of(cls, K: float, over: Any, series: Any, deviation: float) -> "GeneralizedMaxwell":
        pairs = zip(series.modulus.tolist(), series.time.tolist(), strict=True)
        rates = dict(zip(MEASURED_RANGES[0], (1.0 / over[1], 1.0 / over[0]), strict=True))
        found = cls(K, arms=tuple(Arm(*pair) for pair in pairs), **rates)
        object.__setattr__(found, "deviation", deviation)
        return found

    def _read_arms(self, problems: Problems) -> Sequence[Arm]:
        with problems.catching("foundation.arms", self.arms):
            object.__setattr__(self, "arms", _arms_of(self.arms, layer=self.modulus is not None))
            return self.arms
        return ()


@dataclass(frozen=True, eq=False)
class FractionalKelvinVoigt(_Relaxed):
    """A spring in parallel with a springpot: G = K [1 + (t/tau)^(-alpha)/Gamma(1 - alpha)].

    The order alpha is from `LOWEST_ORDER`, below which the springpot is a spring to eight digits, to 1.
    With `order` alpha = 1 it is the Kelvin-Voigt foundation. Below 1 its damping in slow sliding is
    infinite: the springpot relaxes too slowly for int (G - K) dt to converge.

    >>> FractionalKelvinVoigt("10 GN/m^3", "100 ms", 0.5).slow_damping
    inf
    """

    kind: ClassVar[str] = SPRINGPOT
    springpot: ClassVar[bool] = True
    retardation_time: Value = quantity(
        "s", "tau, time scale of the springpot", default=None, needed=True
    )
    order: Value = quantity(
        "1", "alpha, order of the springpot", default=None, needed=True,
        minimum=LOWEST_ORDER, exclusive=False, maximum=1.0,
    )  # fmt: skip

    @property
    def slow_damping(self) -> Value:
        """Int (G - K) dt, in N s/m^3."""
        if self.stiffness is None:
            return None
        finite = self.stiffness * self.retardation_time
        if np.ndim(self.order) == 0:
            return finite if self.order == 1.0 else math.inf
        return np.where(self.order == 1.0, finite, math.inf)


AnyFoundation = Foundation | GeneralizedMaxwell | FractionalKelvinVoigt
FOUNDATIONS: dict[str, Any] = {
    cls.kind: cls for cls in (Foundation, GeneralizedMaxwell, FractionalKelvinVoigt)
}
"""The kinds that a scene file can name."""


def _arms_of(given: Any, *, layer: bool) -> tuple[Arm, ...]:
    """Return the arms of a Prony series from pairs, or from arms; those of a layer have moduli."""
    pairs_expected, own = (OF_LAYER, "modulus") if layer else (PAIRS, "stiffness")
    if isinstance(given, tuple) and not given:
        raise SceneError([f"foundation.arms: missing; expected {pairs_expected}"])
    listed = isinstance(given, Sequence) and not isinstance(given, str)
    if not (listed and 1 <= len(given) <= MOST_ARMS):
        raise ValueError(f"expected 1 to {MOST_ARMS} {pairs_expected}")
    which = "a layer with foundation.modulus" if layer else "only a layer, with foundation.modulus,"
    mixed = f"{which} has arms with moduli{' too' * layer}"
    problems = Problems()
    arms: dict[int, Arm] = {}
    for number, pair in enumerate(given):
        key = f"foundation.arms[{number}]"
        if isinstance(pair, Arm):
            other = (pair.modulus is not None) != layer
        elif _is_pair(pair):
            other = _reads(pair[0], "N/m^3" if layer else "N/m^2")
        else:
            problems.add(key, pair, f"expected one of {pairs_expected}")
            continue
        if other:
            raise mistake(key, pair, f"{mixed}; expected {pairs_expected}")
        try:
            whole = isinstance(pair, Arm)
            arms[number] = (
                copy.copy(pair) if whole else Arm(**{own: pair[0]}, relaxation_time=pair[1])
            )
        except SceneError as error:
            hint = RELATIVE if isinstance(pair, Sequence) and _relative(pair[0]) else ""
            problems += [line.replace("arm", key, 1) + hint for line in error.problems]
    problems += _equal_times(arms)
    problems.report()
    return tuple(arms.values())


def _relative(value: Any) -> bool:
    """Whether a modulus is a number from 0 to 1 without a unit, as in the cards of other programs."""
    with suppress(ValueError):
        return isinstance(value, str) and 0.0 < float(value) < 1.0
    return False


def _reads(value: Any, unit: str) -> bool:
    """Whether a value with a unit is of this dimension."""
    sample = written_sample(value)
    with suppress(ValueError):
        return sample is not None and to_si(sample, unit) is not None
    return False


def _equal_times(arms: Mapping[int, Arm]) -> list[str]:
    """Report the arms that have a relaxation time in common."""
    if not arms:
        return []
    numbers = list(arms)
    times = np.stack(np.broadcast_arrays(*(arm.relaxation_time for arm in arms.values())))
    times = times.reshape(len(arms), -1)
    order = np.argsort(times, axis=0, kind="stable")
    times = np.take_along_axis(times, order, axis=0)
    close = np.argwhere(times[1:] <= times[:-1] * (1.0 + DISTINCT))
    pairs = {(numbers[order[i, j]], numbers[order[i + 1, j]]): times[i, j] for i, j in close}
    return [
        f"foundation.arms[{one}] and foundation.arms[{two}] have the relaxation time {time:g} s in "
        "common; expected one arm with the sum of both"
        for (one, two), time in pairs.items()
    ]
