"""Scene files: TOML in and out, overrides, and the commented template."""

import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.scene.arguments import a_scene, checked, file_name, names
from kvtheory.scene.drives import SPRING
from kvtheory.scene.foundations import (
    FOUNDATIONS,
    LAYER,
    OF_LAYER,
    PAIRS,
    WLF_PAIR,
    Foundation,
    GeneralizedMaxwell,
    arms_of,
)
from kvtheory.scene.indenters import SHAPES
from kvtheory.scene.model import SUPPORTS, WEIGHED, Drive, Run, Scene, lacks_mass
from kvtheory.scene.quantities import (
    MEANT,
    Quantity,
    SceneError,
    absent,
    as_given,
    closest,
    collecting,
    converted,
    given,
    misfits,
    missing,
    mistake,
    nearest,
    problem,
    quantities,
    required,
    shown,
    written_as,
)
from kvtheory.scene.tables import history_from, read_text
from kvtheory.scene.units import expected
from kvtheory.scene.waveforms import WAVEFORMS

SECTIONS = ("indenter", "foundation", "support", "drive", "run")
CHOICES = {
    "indenter": ("shape", SHAPES),
    "foundation": ("kind", FOUNDATIONS),
    "support": ("kind", SUPPORTS),
}
"""Sections in which one key selects the model; the other keys depend on it."""
DEFAULTS = {"indenter": "parabola", "foundation": "kelvin-voigt"}
LISTS = {("foundation", "arms"), ("foundation", "wlf"), ("drive", "history")}
"""Keys whose values are lists of pairs."""
PER_WIDTH = {
    key for cls in SUPPORTS.values() for key, spec in quantities(cls).items() if spec.per_width
}
"""Keys of a support that are masses, loads and springs."""
BALL = " (a sphere takes total mass in kg, load in N and stiffness in N/m)"
POINTS = 'points such as ["50 ms", "100 mm/s"]'
DRIVES = ("velocity", "history", "waveform", "file")
"""Keys that define the motion of a drive; a scene has one of them."""
PLAIN = {"drive": Drive, "run": Run}
OPTIONAL = {"run"}
NOTES = {
    "indenter": [
        '# or a ball: shape = "sphere"; masses, loads and springs are then totals: mass = "1 kg"',
        '# radius_across = "20 mm"  of a ball with another radius across the sliding direction',
    ],
    "support": [
        "# or, instead of mass times gravity, a load; the mass is then inertia alone (load/gravity):",
        '# load = "9.80665 N/mm"',
    ],
    "foundation": [
        "# or, instead of the stiffness, a thin layer bonded to a rigid base:",
        '# modulus = "20 MPa"',
        '# thickness = "0.2 mm"',
        "# poisson_ratio = 0.3",
        "# or another foundation:",
        '# kind = "generalized-maxwell" with arms = [["30 GN/m^3", "10 ms"], ["5 GN/m^3", "1 s"]]',
        "#     instead of the retardation time: stiffness and relaxation time of each arm, or, of a",
        '#     layer, modulus and relaxation time: arms = [["30 MPa", "10 ms"]]',
        '# kind = "fractional-kelvin-voigt" with order = 0.5',
        "# at another temperature than that at which its times were measured, which shifts them:",
        '# temperature = "60 degC"',
        '# reference_temperature = "23 degC"',
        '# wlf = ["17.44", "51.6 K"]            # C_1 and C_2; or activation_energy = "80 kJ/mol"',
    ],
}
"""What the template says about keys that can be given instead of others."""


@checked(path=file_name, overrides=names)
def load_scene(path: str | Path | None = None, overrides: Iterable[str] = ()) -> Scene:
    """Read a scene from a TOML file, or take Table 1 where `path` is None.

    Parameters
    ----------
    path
        The scene file.
    overrides
        Texts ``"section.key=value"`` that replace or add keys. A new ``support.kind`` or
        ``indenter.shape`` keeps the keys that it has in common with the old one; without a file,
        Table 1 gives the others.

    Raises
    ------
    SceneError
        Listing every mistake in the file and the overrides.
    OSError
        If the file cannot be read.

    Examples
    --------
    >>> load_scene(overrides=["drive.velocity=50 mm/s"]).drive.velocity
    0.05
    """
    overrides = list(overrides)
    if path is None and not overrides:
        return Scene.table1()
    return _build(*_overridden(path, overrides))


def drive_file(path: str | Path | None, overrides: Iterable[str]) -> str:
    """Return the name of the file that gives the drive of a scene, or nothing; it is read with the scene."""
    drive = _overridden(path, list(overrides))[0].get("drive")
    return str(drive.get("file", "")) if isinstance(drive, dict) else ""


def _overridden(path: str | Path | None, overrides: list[str]) -> tuple[dict[str, Any], list[str]]:
    """Return the tables of a scene file, or of Table 1, and the mistakes in the overrides."""
    tables = _tables(Scene.table1()) if path is None else _read(Path(path))
    drive = tables.get("drive")
    if path is not None and isinstance(drive, dict) and isinstance(drive.get("file"), str):
        drive["file"] = str(Path(path).parent / drive["file"])  # beside the scene
    return tables, _override(tables, overrides, embedded=path is None)


@checked(scene=a_scene)
def to_toml(scene: Scene) -> str:
    """Return a scene as TOML text in SI units; `load_scene` reads it back equal to the last bit.

    Raises
    ------
    ValueError
        If the indenter or the drive is made of Python functions, which a file cannot hold.

    Examples
    --------
    >>> from kvtheory.scene import Scene
    >>> print(to_toml(Scene()).splitlines()[1])
    shape = "parabola"
    """
    lines = []
    for section, table in _tables(scene).items():
        lines.append(f"[{section}]")
        lines += [f"{key} = {_toml(value)}" for key, value in table.items()]
        lines.append("")
    return "\n".join(lines)


def template(support: str = "dead-weight") -> str:
    """Return Table 1 as a scene file with a comment on every key."""
    examples = {
        "radius": "10 mm", "stiffness": "10 GN/m^3", "retardation_time": "100 ms",
        "depth": "0.3 mm", "mass": "1 kg/mm", "gravity": "9.80665 m/s^2",
        "velocity": "100 mm/s", "duration": "200 ms",
    }  # fmt: skip
    scene = Scene.table1(support)
    lines = ["# A scene for kvtheory: a rigid indenter slides on a viscoelastic foundation.", ""]
    for section in SECTIONS:
        part = getattr(scene, section)
        lines.append(f"[{section}]")
        if section in CHOICES:
            key, models = CHOICES[section]
            lines.append(
                f'{key} = "{getattr(type(part), key)}"{" " * 12}# or one of: {", ".join(models)}'
            )
        for name, spec in given(part).items():
            value = "30 MN/m^2" if spec.unit == "N/m^2" else examples[name]
            lines.append(f'{name} = "{value}"'.ljust(36) + f"# {spec.words}")
        lines += NOTES.get(section, ()) if support != "fixed" or section != "support" else ()
        if section == "drive":
            lines += [
                "# or a history, linear between its points, a jump where a time is repeated:",
                '# history = [["0 ms", "100 mm/s"], ["50 ms", "100 mm/s"], ["50 ms", "0 mm/s"]]',
                '# or from a table: file = "drive.csv", whose first line is t [ms],V [mm/s]',
                '# or: waveform = "sine" or "triangle" with amplitude, frequency and mean,',
                '#     waveform = "smooth-ramp" with velocity and rise_time',
                "# and, if the drive holds the indenter by a spring along x:",
                '# stiffness = "1 MN/m^2"',
                '# damping = "0 N*s/m^2"             # beside the spring; this is the default',
                '# mass = "1 kg/mm"                  # that moves along x; by default that of the support',
            ]
        lines.append("")
    return "\n".join(lines)


def _tables(scene: Scene) -> dict[str, dict[str, Any]]:
    """Return the scene as the tables of its TOML file."""
    tables: dict[str, dict[str, Any]] = {}
    for section in SECTIONS:
        part = getattr(scene, section)
        table: dict[str, Any] = {}
        if section in CHOICES:
            table[CHOICES[section][0]] = getattr(type(part), CHOICES[section][0])
        for name, spec in given(part).items():
            unit = spec.fitting(scene.indenter.per_width).unit
            table[name] = _text(as_given(getattr(part, name)), unit)
        if section == "drive" and part.history is not None:
            table["history"] = [[_text(t, "s"), _text(v, "m/s")] for t, v in part.history]
        if section == "foundation" and part.arms:
            first, unit = (
                ("modulus", "N/m^2") if part.modulus is not None else ("stiffness", "N/m^3")
            )
            table["arms"] = [
                [_text(getattr(arm, first), unit), _text(as_given(arm.relaxation_time), "s")]
                for arm in part.arms
            ]
        if section == "foundation" and part.wlf is not None:
            table["wlf"] = [part.wlf.c_1, _text(part.wlf.c_2, "K")]
        tables[section] = table
    if tables["indenter"]["shape"] not in SHAPES:
        raise ValueError(
            "`scene` has an indenter made of Python functions, which a file cannot hold"
        )
    waveform = scene.drive.waveform
    if waveform is not None:
        own = {
            name: _text(getattr(waveform, name), q.unit) for name, q in quantities(waveform).items()
        }
        tables["drive"] = {"waveform": waveform.waveform, **own, **tables["drive"]}
    elif scene.drive.function is not None:
        raise ValueError("`scene` has a drive made of a Python function, which a file cannot hold")
    return tables


def _text(value: Any, unit: str) -> Any:
    if isinstance(value, np.ndarray):
        return [_text(each, unit) for each in (value.tolist() if value.ndim == 1 else value)]
    return value if unit == "1" else f"{value!r} {unit}"


def _toml(value: Any) -> str:
    if isinstance(value, list):
        return "[" + ", ".join(_toml(item) for item in value) + "]"
    return f'"{value}"' if isinstance(value, str) else repr(value)


def _read(path: Path) -> dict[str, Any]:
    text = ""
    try:
        text = read_text(path)
        return tomllib.loads(text)
    except UnicodeDecodeError:
        told = "it is not text in UTF-8, UTF-16 or Windows-1252"
    except RecursionError:
        told = "its brackets are nested too deep"
    except ValueError as error:  # of TOML, or an endless integer
        told = (
            f'{error}{_line(text, error)}; a quantity is text in quotes, such as radius = "10 mm"'
        )
    raise SceneError([f"{path} is not a TOML file: {told}"])


def _line(text: str, error: ValueError) -> str:
    """Quote the line that an error of TOML names."""
    number = re.search(r"at line (\d+)", str(error))
    return f": {shown(text.splitlines()[int(number[1]) - 1].strip())}" if number else ""


def _parsed(overrides: list[str]) -> tuple[list[tuple[str, str, str]], list[str]]:
    """Return section, key and value of each text, and what was wrong with the others."""
    problems, pairs = [], []
    for text in overrides:
        key, separator, value = text.partition("=")
        section, _, name = key.strip().partition(".")
        if not (separator and section and name):
            near = closest(key.strip(), _all_keys())
            hint = f'did you mean "{near}"? ' if near not in ("", None, key.strip()) else ""
            problems.append(
                f'`overrides` "{text}": {hint}expected KEY=VALUE, such as drive.velocity="50 mm/s"'
            )
            continue
        value = value.strip()
        if len(value) > 1 and value[0] == value[-1] and value[0] in "\"'":
            value = value[1:-1]
        pairs.append((section, name, value))
    return pairs, problems


def _override(tables: dict[str, Any], overrides: list[str], *, embedded: bool) -> list[str]:
    """Apply ``section.key=value`` texts in place; return what was wrong with them."""
    pairs, problems = _parsed(overrides)
    keys = {(section, name) for section, name, _ in pairs}
    for section, name, value in pairs:
        if section in CHOICES and name == CHOICES[section][0]:
            tables[section] = _switched(tables.get(section), section, value, embedded)
    if embedded and not _is_per_width(tables):  # what Table 1 gives does not fit a ball
        kept = {key: value for key, value in tables["support"].items() if key not in PER_WIDTH}
        tables["support"] = kept
    for section, name, value in pairs:
        table = tables.setdefault(section, {})
        if not isinstance(table, dict):
            continue
        if section == "drive" and name not in table:
            _change_drive(table, name)
        if section == "foundation" and name in (specs := quantities(Foundation)):
            for other in specs[name].excludes:
                if (section, other) not in keys:
                    table.pop(other, None)
        if (section, name) == ("foundation", "wlf") and (section, "activation_energy") not in keys:
            table.pop("activation_energy", None)
        try:
            listed = (section, name) in LISTS or value.startswith("[")
            table[name] = tomllib.loads(f"v = {value}")["v"] if listed else value
        except (ValueError, RecursionError):
            table[name] = value
    return problems


def _all_keys() -> list[str]:
    """Return the keys of all sections, whatever their models."""
    models = {name: tuple(known.values()) for name, (_, known) in CHOICES.items()}
    models |= {name: (cls,) for name, cls in PLAIN.items()}
    return [f"{name}.{key}" for name in SECTIONS for cls in models[name] for key in _keys(cls)]


def _change_drive(table: dict[str, Any], name: str) -> None:
    """Remove from a drive the keys that a new key excludes: a drive has only one of `DRIVES`.

    A spring is compatible with each of them.
    """
    own = quantities(WAVEFORMS[table["waveform"]]) if table.get("waveform") in WAVEFORMS else ()
    if name in DRIVES and name not in own:
        spring = {key: table[key] for key in SPRING if key in table}
        table.clear()
        table.update(spring)


def _switched(old: Any, section: str, choice: str, embedded: bool) -> dict[str, Any]:
    """Return a section for another shape or support, with the keys that it shares with the old one.

    Table 1 gives both the mass and the depth, so that the built-in scene can switch its support.
    """
    chooser, models = CHOICES[section]
    meant = closest(choice, models)
    names = _keys(models[meant]) if meant else ()
    built_in = _tables(Scene.table1(choice))[section] if embedded and choice in SUPPORTS else {}
    common = {k: v for k, v in old.items() if k in names} if isinstance(old, dict) else {}
    return {**built_in, **common, chooser: choice}


def _is_per_width(tables: Mapping[str, Any]) -> bool:
    """Tell whether the forces on the indenter are per unit width: on any but a ball."""
    indenter = tables.get("indenter")
    shape = indenter.get("shape") if isinstance(indenter, dict) else None
    return not isinstance(shape, str) or getattr(SHAPES.get(shape), "per_width", True)


def _build(tables: Mapping[str, Any], problems: list[str]) -> Scene:
    """Make the scene, or raise with every problem found on the way."""
    problems = list(problems)
    problems += [
        f"[{name}]: unknown section; {nearest(name, SECTIONS)}"
        for name in tables
        if name not in SECTIONS
    ]
    missing = [name for name in absent(SECTIONS, tables) if name not in OPTIONAL]
    problems += [f"[{name}]: this section is missing" for name in missing]
    parts, per_width = {}, _is_per_width(tables)
    for section in (name for name in SECTIONS if name in tables):
        with collecting(problems, section, tables[section]):
            parts[section] = _part(section, tables[section], per_width)
    for section in WEIGHED if "indenter" in parts else ():
        problems += misfits(section, parts.get(section), parts["indenter"])
    if {"support", "drive"} <= parts.keys():
        problems += lacks_mass(parts["support"], parts["drive"], per_width)
    if problems:
        raise SceneError(problems)
    return Scene(**parts)


def _part(section: str, table: Any, per_width: bool) -> Any:
    """Make one part of a scene from its table."""
    if not isinstance(table, dict):
        told = f"expected one table with this name, not {type(table).__name__}"
        raise SceneError([f"[{section}]: {told}"])
    if section == "drive" and "waveform" in table:
        return _waveform(table, per_width)
    if section not in CHOICES:
        return PLAIN[section](**_values(PLAIN[section], section, table, per_width))
    chooser, models = CHOICES[section]
    rest = {key: value for key, value in table.items() if key != chooser}
    name = table.get(chooser, DEFAULTS.get(section))
    if isinstance(name, str) and name in models:
        return models[name](
            **_values(models[name], section, rest, per_width, f'{chooser} = "{name}"')
        )
    problems = []
    if chooser not in table and absent([chooser], table):
        problems.append(f"{section}.{chooser}: missing; expected one of: {', '.join(models)}")
    elif chooser in table:
        one = f"expected exactly one of: {', '.join(models)}"
        what = nearest(name, models) if isinstance(name, str) else one
        problems.append(problem(f"{section}.{chooser}", name, what))
    meant = closest(name, models) if isinstance(name, str) else None
    valid = [chooser, *dict.fromkeys(key for model in models.values() for key in _keys(model))]
    if meant is None:
        problems += [
            problem(f"{section}.{key}", value, f"unknown key; {nearest(key, valid)}")
            for key, value in rest.items()
            if key not in valid
        ]
    else:
        with collecting(problems, section, table):
            models[meant](
                **_values(models[meant], section, rest, per_width, f'{chooser} = "{meant}"')
            )
    raise SceneError(problems)


def _waveform(table: Mapping[str, Any], per_width: bool) -> Drive:
    """Make a drive that swings or rises smoothly."""
    name = table["waveform"]
    rest = {key: value for key, value in table.items() if key != "waveform"}
    if not (isinstance(name, str) and name in WAVEFORMS):
        raise mistake("drive.waveform", name, nearest(str(name), WAVEFORMS))
    values = _values(WAVEFORMS[name], "drive", rest, per_width, f'waveform = "{name}"')
    spring = {key: values.pop(key) for key in SPRING if key in values}
    return Drive(waveform=WAVEFORMS[name](**values), **spring)


def _values(
    cls: Any, section: str, table: Mapping[str, Any], per_width: bool, choice: str = ""
) -> dict[str, Any]:
    """Return the arguments of `cls`; for a waveform they include the spring of its drive."""
    specs, valid = quantities(cls), _keys(cls)
    if section == "drive":
        specs |= {name: quantities(Drive)[name] for name in SPRING}
    known = [CHOICES[section][0], *valid] if section in CHOICES else valid
    of = f" for {choice}" if choice else ""
    needed = required(cls, table)
    problems = []
    for name in (name for name in absent(valid, table) if name in needed):
        spec = specs[name].fitting(per_width)
        problems.append(missing(section, name, spec, of + ("" if spec == specs[name] else BALL)))
    layer = any(name in table for name in LAYER) and "stiffness" not in table
    pairs = OF_LAYER if layer else PAIRS
    if "arms" in absent(valid, table):
        problems.append(f"{section}.arms: missing{of}; expected {pairs}")
    values: dict[str, Any] = {}
    for key, value in table.items():
        if key not in valid:
            elsewhere = "" if MEANT.get(key, key) in known else _elsewhere(section, key)
            told = f"unknown key{of}; {elsewhere or nearest(key, known)}"
            problems.append(problem(f"{section}.{key}", value, told))
            continue
        with collecting(problems, f"{section}.{key}", value):
            if cls is Drive and key == "file":
                values["history"] = history_from(Path(str(value)))
            elif key == "arms":
                values["arms"] = arms_of(_pairs(value, pairs), layer=layer)
            elif key == "wlf":
                _pairs([value[1:]] if isinstance(value, list) else value, WLF_PAIR)
                values["wlf"] = value
            else:
                values[key] = _value(value, specs[key]) if key in specs else _pairs(value, POINTS)
    if problems:
        raise SceneError(problems)
    return values


def _elsewhere(section: str, key: str) -> str:
    """Return which other models of a section have a key of this name, or a similar one."""
    if section not in CHOICES:
        return ""
    chooser, models = CHOICES[section]
    names = {name for model in models.values() for name in _keys(model)}
    meant = key if key in names else MEANT.get(key, "")
    having = [f'"{name}"' for name, model in models.items() if meant in _keys(model)]
    return f"{meant} is of {chooser} = {' or '.join(having)}" if having else ""


def _value(value: Any, spec: Quantity) -> Any:
    """Return a value in SI, or the text itself where its unit tells whether it is per unit width."""
    items = value if isinstance(value, list) else [value]
    if spec.unit != "1" and any(isinstance(item, (int, float)) for item in items):
        raise ValueError(f"has no unit; expected {expected(spec.unit)}")
    number = converted(value, written_as(value, spec))
    return value if spec.per_width else number


def _pairs(value: Any, told: str) -> Any:
    """Return a list of pairs unchanged, for later checks, if all of them carry units."""
    pairs = value if isinstance(value, list) else []
    items = (item for pair in pairs if isinstance(pair, list) for item in pair)
    if any(isinstance(item, (int, float)) for item in items):
        raise ValueError(f"has numbers without a unit; expected {told}")
    return value


def _keys(cls: Any) -> list[str]:
    """Return the keys of a model: its quantities, and its other keys, such as lists of pairs."""
    lists: tuple[str, ...] = DRIVES if cls is Drive else ()
    if cls in FOUNDATIONS.values():
        lists = ("arms", "wlf") if cls is GeneralizedMaxwell else ("wlf",)
    elif cls in WAVEFORMS.values():
        lists = SPRING
    return list(dict.fromkeys((*quantities(cls), *lists)))
