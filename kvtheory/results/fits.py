"""What was fitted to measurements: the foundation from moduli, the quantities of a scene from friction."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from textwrap import wrap
from typing import Any, ClassVar, NamedTuple

import numpy as np

from kvtheory.export import Columns, above
from kvtheory.results.presented import Exported, Recorded, aligned
from kvtheory.scene.files import to_toml
from kvtheory.scene.foundations import GeneralizedMaxwell
from kvtheory.scene.model import Scene
from kvtheory.scene.units import in_celsius

WIDTH = 100


class _Fit(Exported):
    """What fits have in common: a scene that was found, and remarks."""

    heading: ClassVar[str]
    source: str
    scene: Scene | None

    @property
    def remarks(self) -> list[str]:
        """What should be known about the fit, a line each."""
        raise NotImplementedError

    @property
    def _found(self) -> Scene:
        if self.scene is None:
            message = "a foundation from moduli is a layer: give `thickness` and `poisson_ratio`"
            raise ValueError(message)
        return self.scene

    def to_toml(self) -> str:
        """Return the scene with the fitted values as TOML text, with remarks as comments."""
        lines = [self.heading]
        for line in to_toml(self._found).splitlines():
            if line.startswith("arms = "):  # an arm in each line
                pairs = line.removeprefix("arms = [[").removesuffix("]]").split("], [")
                lines += ["arms = [", *(f"  [{pair}]," for pair in pairs), "]"]
                continue
            lines.append(line)
            for remark in self.remarks if line == "[foundation]" else ():
                lines += wrap(remark, WIDTH, initial_indent="# ", subsequent_indent="# ")
        return "\n".join([*lines, ""])

    def _attributes(self) -> Mapping[str, str]:
        return {"source": self.source, "remarks": " ".join(self.remarks)}


@dataclass(frozen=True, repr=False)
class FoundationFit(_Fit):
    """A Prony series fitted to measured moduli, in SI.

    `arms` are pairs of modulus (Pa) and relaxation time (s), by increasing time; `modulus` is that of the
    relaxed material. Moduli are Young's; if the data are stiffnesses per unit area, in N/m^3, `stiffness`
    stands for it. `misfit` is the root mean square of the relative residuals, `largest_misfit` the largest
    of them; no series with non-negative arms has a misfit below `least_misfit`, however many arms it has.

    `shift_factors` are pairs of temperature (degrees Celsius) and log10 a_T, `shift_errors` the standard
    errors of the latter, `shift_law` the law that was fitted to them; the arms are those at the
    `reference_temperature` (K), as in the scene, which shifts them. `frequencies` (Hz) are those that the
    data cover at the reference temperature; sliding at `velocities` (m/s), V over the length of the contact
    of `scene`, is within them. `notes` are remarks on the data. Without a layer there is no `scene`: its
    `foundation` needs `thickness` and `poisson_ratio`.
    """

    heading = "# A scene whose foundation was fitted to measured moduli"
    arms: tuple[tuple[float, float], ...]
    modulus: float | None
    stiffness: float | None
    misfit: float
    largest_misfit: float
    least_misfit: float
    shift_factors: tuple[tuple[float, float], ...] | None
    shift_errors: tuple[float, ...] | None
    shift_law: str | None
    reference_temperature: float | None
    frequencies: tuple[float, float]
    velocities: tuple[float, float] | None
    source: str
    notes: tuple[str, ...] = ()
    scene: Scene | None = field(default=None, repr=False)
    data: Any = field(default=None, repr=False, compare=False)
    """Measured moduli (over rad/s or s), fit, and the sweeps before they were shifted."""

    @property
    def foundation(self) -> GeneralizedMaxwell:
        """The foundation of `scene`."""
        return self._found.foundation  # type: ignore[return-value]

    def to_card(self, suffix: str) -> str:
        """Return the series as a card of Abaqus (``".inp"``) or ANSYS (``".mac"``), in Pa, s and degC.

        WLF's law is in the card; of Arrhenius' law, a comment says that it is not, as `left_out` does.
        """
        nu, cards = self.data["poisson_ratio"], above("fitting.cards")
        if self.modulus is None or nu is None:
            raise ValueError("a card holds moduli and Poisson's ratio: give `poisson_ratio`")
        law, thermal = self.data["law"], None
        if law is not None and not self.left_out:
            thermal = cards.Thermal(law.constants, self.reference_temperature)
        text: str = cards.written(
            suffix, self.modulus, self.arms, nu, self.source, thermal, self.left_out
        )
        return text

    @property
    def left_out(self) -> str:
        """What a card cannot say of the temperature, or nothing."""
        law, T = self.data["law"], self.reference_temperature
        if law is None or law.name == "wlf" or T is None:
            return ""
        return (
            f"Without the law of temperature: the arms hold at {in_celsius(T):.4g} degC. {law.text}"
        )

    @property
    def remarks(self) -> list[str]:
        """What should be known about the fit, a line each."""
        low, high = self.frequencies
        count = f"{len(self.arms)} arm{'s' * (len(self.arms) > 1)}"
        lines = [
            f"Fitted to {self.source}: {count}, misfit {self.misfit:.3g} "
            f"(largest {self.largest_misfit:.3g});",
            f"no series with non-negative arms has a misfit below {self.least_misfit:.3g}.",
            f"The data cover {low:.3g} to {high:.3g} Hz.",
        ]
        if self.velocities is not None:
            low, high = self.velocities
            lines.append(
                f"That is V/c, contact length c, for velocities from {low:.3g} to {high:.3g} m/s."
            )
        if self.shift_law is not None:
            lines.append(f"{self.shift_law}.")
        return [*lines, *self.notes]

    def __repr__(self) -> str:
        unit = "N/m^3" if self.modulus is None else "Pa"
        heads = f"arm [{unit}]", "relaxation time [s]"
        rows = [(f"{E:.6g}", f"{tau:.6g}") for E, tau in self.arms]
        relaxed = self.stiffness if self.modulus is None else self.modulus
        T = self.reference_temperature
        at = "" if T is None else f" at {in_celsius(T):.4g} degC"
        first = f"Prony series{at}, relaxed {relaxed:.6g} {unit}"
        return "\n".join([first, *aligned(heads, rows), *self.remarks])

    def _columns(self) -> Columns:
        x, rows, fitted = self.data["x"], self.data["measured"], self.data["fitted"]
        names = ("storage", "loss") if len(rows) == 2 else ("relaxation",)
        unit = "N/m^3" if self.modulus is None else "Pa"
        columns = {"angular_frequency": (x, "rad/s")} if len(rows) == 2 else {"time": (x, "s")}
        for name, measured, fit in zip(names, rows, fitted, strict=True):
            columns[f"{name}_modulus, data"] = measured, unit
            columns[f"{name}_modulus, fit"] = fit, unit
        return columns


class Parameter(NamedTuple):
    """A fitted quantity of a scene, in SI, and its standard error.

    `interval` is that of 95 % confidence, by the profile of the sum of squares; a limit that the data do not
    give is 0 or infinite. Where the sum of squares has a second minimum that the data allow as well, the
    set of 95 % may have more pieces, `other_intervals`. The standard error is that of linear theory at the
    minimum, or the longer side of the interval over Student's t where that is larger.
    """

    value: float
    standard_error: float
    interval: tuple[float, float]
    other_intervals: tuple[tuple[float, float], ...] = ()


class WeighedModel(NamedTuple):
    """A foundation that was fitted: its unknowns, misfit, AICc above the least, and weight among all.

    The weight is NaN where the best one does not fit to the scatter: weights hold if one of them is true.
    """

    name: str
    unknowns: int
    misfit: float
    aicc: float
    weight: float


@dataclass(frozen=True, repr=False)
class FrictionFit(_Fit):
    """Quantities of a scene fitted to measured friction.

    `parameters` maps keys of the scene to `value` and `standard_error`, in SI; `correlations` is the matrix
    of the correlations of their logarithms, in the same order. `not_identifiable` lists the keys that the
    data cannot tell, or cannot tell apart: a combination of them is uncertain by more than a factor of two.
    `misfit` is the root mean square of the residuals, over velocity relative to the geometric mean of the
    measured and the fitted value, over time to the root mean square of what is measured. `models` are the
    foundations that were weighed. `scene` is the scene with the fitted values.
    """

    heading = "# A scene whose quantities were fitted to measured friction"
    parameters: Mapping[str, Parameter]
    correlations: tuple[tuple[float, ...], ...]
    not_identifiable: tuple[tuple[str, ...], ...]
    misfit: float
    model: str
    models: tuple[WeighedModel, ...]
    source: str
    notes: tuple[str, ...] = ()
    scene: Scene = field(default_factory=Scene, repr=False)
    data: Any = field(default=None, repr=False, compare=False)
    """Conditions, measured and fitted quantities and relative residuals by name, and units."""

    @property
    def remarks(self) -> list[str]:
        """What should be known about the fit, a line each."""
        rows = sum(each.size for each in self.data["sets"])
        lines = [f"Fitted to {self.source}: {rows} rows, misfit {self.misfit:.3g}."]
        for keys in dict.fromkeys(self.not_identifiable):
            apart = " apart: a combination of them" if len(keys) > 1 else ": it"
            doubt = "is uncertain by more than a factor of two"
            lines.append(f"The data cannot tell {', '.join(keys)}{apart} {doubt}.")
        return [*lines, *self.notes]

    def __repr__(self) -> str:
        specs = self.scene.replaceable
        rows = [
            (
                key,
                f"{value:.5g}",
                f"{error:.2g}",
                specs[key].unit if key in specs else "1",
                f"{error / value:.2g}",
                " or ".join(f"{low:.4g} to {high:.4g}" for low, high in (own, *others)),
            )
            for key, (value, error, own, others) in self.parameters.items()
        ]
        heads = "quantity", "value", "standard error", "unit", "relative", "95 % interval"
        lines = aligned(heads, rows)
        if self.models:
            columns = "model", "unknowns", "misfit", "AICc", "weight"
            weighed = [
                (
                    m.name,
                    str(m.unknowns),
                    f"{m.misfit:.3g}",
                    f"+{m.aicc:.1f}",
                    f"{m.weight:.0%}" if m.weight == m.weight else "-",
                )
                for m in self.models
            ]
            lines += ["", *aligned(columns, weighed)]
        return "\n".join([f"Fit of {self.model}", *lines, "", *self.remarks])

    def _columns(self) -> Columns:
        specs, units = self.scene.replaceable, self.data["units"]
        sets, columns = self.data["sets"], dict[str, Any]()
        most = max(each.size for each in sets)
        for each, fitted in zip(sets, self.data["fitted"], strict=True):
            of = f" ({each.source})" if len(sets) > 1 else ""
            own = {"time": (each.time, "s")} if each.time is not None else {}
            own |= {key: (v, specs[key].unit) for key, v in each.conditions.items()}
            for name, values in each.measured.items():
                own |= {
                    f"{name}, data": (values, units[name]),
                    f"{name}, fit": (fitted[name], units[name]),
                }
            for name, (values, unit) in own.items():
                held = np.full(most, np.nan)
                held[: each.size] = values
                columns[f"{name}{of}"] = held, unit
        return columns


@dataclass(frozen=True)
class FewerArms(Recorded):
    """A Prony series with fewer arms, pairs of stiffness (N/m^3) and relaxation time (s).

    `difference` is the largest relative change of the friction coefficient at the velocities, from the
    first to the last in m/s; `bound` is proved to be no less, NaN where none is known. `scene` is the scene
    with these arms.
    """

    arms: tuple[tuple[float, float], ...]
    bound: float
    difference: float
    velocities: tuple[float, float]
    scene: Scene = field(repr=False)
