"""The reference of scene files: every key with its unit, its range and its default."""

import dataclasses
import math
from typing import Any

from generators.api import escaped
from kvtheory.scene import template
from kvtheory.scene.files import DEFAULTS, DRIVES
from kvtheory.scene.model import SECTIONS, Scene
from kvtheory.scene.quantities import quantities, required
from kvtheory.scene.waveforms import WAVEFORMS


def pages() -> dict[str, str]:
    """Return one page about all keys."""
    parts = ["# Scene files", _HEAD]
    for section, (chooser, models) in SECTIONS.items():
        parts.append(f"## [{section}]")
        if chooser:
            default = (
                f", `{DEFAULTS[section]}` by default" if section in DEFAULTS else ", to be given"
            )
            parts.append(
                f"`{chooser}` is one of {', '.join(f'`{name}`' for name in models)}{default}."
            )
            for name, model in models.items():
                parts += [f"### {chooser} = {name}", _table(model)]
            if section == "foundation":
                parts.append(_ARMS)
        else:
            parts.append(_table(models[section]))
        if section == "drive":
            parts.append(_DRIVES.format(ways=", ".join(f"`{name}`" for name in DRIVES)))
            for name, model in WAVEFORMS.items():
                parts += [f"### waveform = {name}", _table(model)]
    parts += ["## A template", f"`kvtheory scene` prints it:\n\n```toml\n{template()}\n```"]
    return {"scene-keys.md": "\n\n".join(parts) + "\n"}


def _table(model: Any) -> str:
    needed, defaults = set(required(model)), {f.name: f.default for f in dataclasses.fields(model)}
    rows = [
        f"| `{name}` | {escaped(spec.unit)} | {escaped(spec.doc)} | {spec.range} | "
        f"{_default(name, spec, needed, defaults[name])} |"
        for name, spec in quantities(model).items()
    ]
    return "\n".join(["| key | unit | meaning | range | default |", "|---|---|---|---|---|", *rows])


def _default(name: str, spec: Any, needed: set[str], default: Any) -> str:
    if spec.instead:
        return f"needed, or `{spec.instead}`"
    if name in needed:
        return "needed"
    if isinstance(default, (int, float)) and math.isfinite(default):
        return f"{default:g} {spec.unit}".replace(" 1", "") if spec.unit != "1" else f"{default:g}"
    if spec.beside:
        return f"with {', '.join(f'`{each}`' for each in spec.beside)}"
    return "none"


_HEAD = f"""A scene is a TOML file. Every quantity is text with a unit, such as `"10 mm"`, in any unit of the
same dimension; dimensionless quantities are bare numbers. A quantity without its unit is an error. All
mistakes in a file are reported at once. These tables are generated from the code. Without a file the scene
is Table 1 of the paper, with `{Scene().support.kind}` support."""
_ARMS = """`arms` of a `generalized-maxwell` foundation is a list of pairs of stiffness and relaxation time,
`[["30 GN/m^3", "10 ms"], ["5 GN/m^3", "1 s"]]`. In a layer, given by `modulus`, `thickness` and
`poisson_ratio`, they are pairs of modulus and relaxation time, `[["30 MPa", "10 ms"]]`, and their stiffness
follows from the layer as that of the foundation does. `stiffness_from` says how: `"rest"`, the default, gives
the K on which the indenter at rest has the depth and the load that it has on the elastic layer, of any
thickness; `"thin"` gives E (1 - nu)/((1 + nu)(1 - 2 nu) h). `damping` is that of a damper beside the arms; a
layer takes none, as a damping per unit area would not follow its thickness.

`temperature` multiplies every time of a foundation by a_T. The times in the file are those at the
`reference_temperature`; the law is `wlf = ["17.44", "51.6 K"]`, the constants C_1 and C_2 of
log10 a_T = -C_1 (T - T_ref)/(C_2 + T - T_ref), or an `activation_energy`. Without `temperature` the
foundation is at its reference temperature."""
_DRIVES = """A drive has one of {ways}. A `history` is a list of pairs of time and velocity, linear between
its points, with a jump where a time is repeated. A `file` is a table with the columns `t [ms]` and
`V [mm/s]`; its path is relative to the scene file."""
