"""Whether steady sliding is stable."""

from dataclasses import dataclass
from typing import Any

from kvtheory.results.certificate import Certificate, Value, record


@dataclass(frozen=True)
class Stability:
    """Stability of steady sliding: each quantity a value, or an array where the input was an array.

    `stable` is meant against small disturbances: the real parts of all rates are negative.
    `rates` holds, along its last axis but one, the rates of small motions in 1/s as pairs (real,
    imaginary), fastest growth first, and `time_constants` -1/real of each in s: negative for a growing
    motion. Above `critical_stiffness` (N/m^2, of a ball N/m) of the spring in the drive steady sliding is
    stable, and below `lower_critical_stiffness`, too, which is 0 where friction falls with velocity.
    `frequency` (Hz) is that of the motion at the onset of instability, at the upper critical stiffness.
    `critical_velocity` (m/s) is that of the onset of instability: the smallest at which the present stiffness
    becomes critical. It is not V* of `kvtheory.asymptotes`, where the asymptotes of friction cross.
    Values that do not exist, or were not requested, are NaN.
    """

    stable: Any
    rates: Value
    time_constants: Value
    critical_stiffness: Value
    lower_critical_stiffness: Value
    critical_velocity: Value
    frequency: Value
    rigid_drive: bool
    model: str
    certificate: Certificate

    def as_dict(self) -> dict[str, Any]:
        """Return plain Python values, ready for JSON; a missing value is None."""
        return record(self)
