"""Scene files: TOML in and out, overrides, and the commented template."""

import json
import math
import re
import tomllib
from collections.abc import Iterable, Mapping
from contextlib import suppress
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from kvtheory.scene.arguments import a_scene, checked, file_name, flag, names
from kvtheory.scene.columns import depths_from, history_from
from kvtheory.scene.drives import SPRING
from kvtheory.scene.foundations import FOUNDATIONS, Foundation, GeneralizedMaxwell
from kvtheory.scene.indenters import SHAPES
from kvtheory.scene.layer import THIN_WAY
from kvtheory.scene.mistakes import (
    ELSE,
    MEANT,
    Bare,
    Problems,
    SceneError,
    absent,
    closest,
    nearest,
    shown,
)
from kvtheory.scene.model import SECTIONS, SUPPORTS, Drive, Fixed, Scene, inconsistencies
from kvtheory.scene.quantities import (
    Quantity,
    as_given,
    converted,
    given,
    missing,
    quantities,
    required,
)
from kvtheory.scene.start import Start
from kvtheory.scene.tables import read_text
from kvtheory.scene.waveforms import WAVEFORMS

CHOOSERS = {section: chooser for section, (chooser, _) in SECTIONS.items() if chooser}
"""The key of each section that selects a model, on which the other keys depend."""
MODELS = {section: models for section, (_, models) in SECTIONS.items()}
DEFAULTS = {
    "indenter": "parabola", "foundation": "kelvin-voigt", "drive": "drive", "run": "run", "start": "start",
}  # fmt: skip
LISTS = {
    ("foundation", "arms"),
    ("foundation", "wlf"),
    ("foundation", "shift_factors"),
    ("drive", "history"),
    ("support", "history"),
}
"""Keys whose values are lists of pairs."""
PER_WIDTH = {
    key for cls in SUPPORTS.values() for key, spec in quantities(cls).items() if spec.per_width
}
"""Keys of a support that are per unit width: masses, loads and springs."""
BALL = " (a sphere takes total mass in kg, load in N and stiffness in N/m)"
LARGEST = 10**400
"""Larger integers in a file are read as infinite."""
DRIVES = ("velocity", "history", "waveform", "file")
"""Keys that define the motion of a drive; a scene has one of them."""
DEPTHS = ("depth", "history", "file")
"""Keys that define the depth of a fixed indenter; likewise."""


@checked(path=file_name, overrides=names, foundation=flag)
def load_scene(
    path: str | Path | None = None, overrides: Iterable[str] = (), *, foundation: bool = True
) -> Scene:
    """Read a scene from a TOML file, or take Table 1 where `path` is None.

    Parameters
    ----------
    path
        The scene file.
    overrides
        Texts ``"section.key=value"`` that replace or add keys. A new ``support.kind`` or
        ``indenter.shape`` keeps the keys that it has in common with the old one; without a file,
        Table 1 gives the others.
    foundation
        Whether the file must have a section ``[foundation]``; otherwise Table 1's replaces a missing one.

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
    tables, problems = _overridden(path, overrides)
    unknown = [name for name in tables if name not in SECTIONS]
    problems += [f"[{name}]: unknown section; {nearest(name, SECTIONS)}" for name in unknown]
    optional = ("run", "start") if foundation else ("run", "start", "foundation")
    needed = [name for name in absent(SECTIONS, tables) if name not in optional]
    problems += [f"[{name}]: this section is missing" for name in needed]
    parts: dict[str, Any] = {} if "foundation" in tables else {"foundation": Scene().foundation}
    per_width = _is_per_width(tables)
    for section in (name for name in SECTIONS if name in tables):
        with problems.catching(section, tables[section]):
            parts[section] = _part(section, tables[section], per_width)
    problems += inconsistencies(parts)
    problems.report()
    return Scene(**parts)


def drive_file(path: str | Path | None, overrides: Iterable[str]) -> str:
    """Return the name of the file from which the drive of a scene is read, or an empty text."""
    drive = _overridden(path, list(overrides))[0].get("drive")
    return str(drive.get("file", "")) if isinstance(drive, dict) else ""


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
    tables = _tables(scene)
    if scene.start.at_rest:
        del tables["start"]
    for section, table in tables.items():
        lines.append(f"[{section}]")
        lines += [
            f"{key} = {json.dumps(value, ensure_ascii=False)}" for key, value in table.items()
        ]
        lines.append("")
    return "\n".join(lines)


def template(support: str = "dead-weight") -> str:
    """Return Table 1 as a scene file with a comment on every key."""
    part = Scene.table1(support).support
    lines = [f'kind = "{support}"{" " * 12}# or one of: {", ".join(SUPPORTS)}']
    usual = {"m": "0.3 mm", "kg/m": "1 kg/mm", "N/m^2": "30 MN/m^2", "m/s^2": "9.80665 m/s^2"}
    for name, spec in given(part).items():
        lines.append(f'{name} = "{usual[spec.unit]}"'.ljust(36) + f"# {spec.words}")
    if support == "fixed":
        message = "or a history, linear between its points, or a table with t [s],depth [mm]"
        lines += [f"# {message}:", '# history = [["0 s", "0 mm"], ["1 s", "0.3 mm"]]']
        lines += ['# file = "depth.csv"']
    else:
        message = (
            "instead of mass times gravity, a load; the mass is then inertia alone (load/gravity)"
        )
        lines += [f"# or, {message}:", '# load = "9.80665 N/mm"']
    text = files("kvtheory.scene").joinpath("template.toml").read_text(encoding="utf-8")
    text = text.replace("# SHAPES", ", ".join(SHAPES)).replace("# LAWS", ", ".join(FOUNDATIONS))
    return text.replace("# SUPPORT", "\n".join(lines))


def _tables(scene: Scene) -> dict[str, dict[str, Any]]:
    """Return the scene as the tables of its TOML file."""
    tables: dict[str, dict[str, Any]] = {}
    for section in SECTIONS:
        part = getattr(scene, section)
        tables[section] = table = {}
        if section in CHOOSERS:
            table[CHOOSERS[section]] = getattr(part, CHOOSERS[section])
        for name, spec in given(part).items():
            unit = spec.fitting(scene.indenter.per_width).unit
            table[name] = _text(as_given(getattr(part, name)), unit)
    if tables["indenter"]["shape"] not in SHAPES:
        raise ValueError(
            "`scene` has an indenter made of Python functions, which a file cannot hold"
        )
    foundation, drive = scene.foundation, scene.drive
    if isinstance(foundation, GeneralizedMaxwell):
        first, unit = ("stiffness", "N/m^3") if foundation.modulus is None else ("modulus", "N/m^2")
        tables["foundation"]["arms"] = [
            [_text(getattr(arm, first), unit), _text(as_given(arm.relaxation_time), "s")]
            for arm in foundation.arms
        ]
    if foundation.wlf is not None:
        tables["foundation"]["wlf"] = [foundation.wlf.c_1, _text(foundation.wlf.c_2, "K")]
    if foundation.stiffness_from == THIN_WAY:
        tables["foundation"]["stiffness_from"] = THIN_WAY
    if foundation.shift_factors is not None:
        pairs = foundation.shift_factors
        tables["foundation"]["shift_factors"] = [[_text(T, "K"), log] for T, log in pairs]
    if scene.depths:
        tables["support"]["history"] = [[_text(t, "s"), _text(d, "m")] for t, d in scene.depths]
    if drive.history is not None:
        tables["drive"]["history"] = [[_text(t, "s"), _text(v, "m/s")] for t, v in drive.history]
    elif (wave := drive.waveform) is not None:
        own = {name: _text(getattr(wave, name), q.unit) for name, q in quantities(wave).items()}
        tables["drive"] = {"waveform": wave.waveform, **own, **tables["drive"]}
    elif drive.function is not None:
        raise ValueError("`scene` has a drive made of a Python function, which a file cannot hold")
    return tables


def _text(value: Any, unit: str) -> Any:
    if isinstance(value, np.ndarray):
        return [_text(each, unit) for each in (value.tolist() if value.ndim == 1 else value)]
    return value if unit == "1" else "inf" if value == math.inf else f"{value!r} {unit}"


def _read(path: Path) -> dict[str, Any]:
    """Return the tables of a TOML file."""
    text = ""
    try:
        text = read_text(path)
        tables = tomllib.loads(text)
        for table in tables.values():  # a file is named relative to the scene file
            if isinstance(table, dict) and isinstance(table.get("file"), str):
                table["file"] = str(path.parent / table["file"])
        return tables
    except UnicodeDecodeError:
        message = "it is not text in UTF-8, UTF-16 or Windows-1252"
    except RecursionError:
        message = "its brackets are nested too deep"
    except ValueError as error:  # invalid TOML, or too long an integer
        number = re.search(r"at line (\d+)", str(error))
        line = f": {shown(text.splitlines()[int(number[1]) - 1].strip())}" if number else ""
        hint = 'a quantity is text in quotes, such as radius = "10 mm"'
        if path.suffix.lower() == ".csv":
            hint = "measured or simulated data are read by `fit` and `compare`"
        message = f"{error}{line}; {hint}"
    raise SceneError([f"{path} is not a TOML file: {message}"])


def _overridden(path: str | Path | None, overrides: list[str]) -> tuple[dict[str, Any], Problems]:
    """Return the tables of a scene file, or of Table 1, with overrides, and the mistakes in the overrides."""
    tables: dict[str, Any] = _tables(Scene.table1()) if path is None else _read(Path(path))
    problems = Problems()
    new: dict[tuple[str, str], str] = {}
    for text in overrides:
        key, separator, value = text.partition("=")
        section, _, name = key.strip().partition(".")
        if separator and section and name:
            value = value.strip()
            quoted = len(value) > 1 and value[0] == value[-1] and value[0] in "\"'"
            new[section, name] = value[1:-1] if quoted else value
            continue
        models = [(each, cls) for each, known in MODELS.items() for cls in known.values()]
        near = closest(key.strip(), [f"{each}.{own}" for each, cls in models for own in _keys(cls)])
        hint = f'did you mean "{near}"? ' if near not in ("", None, key.strip()) else ""
        message = f'{hint}expected KEY=VALUE, such as drive.velocity="50 mm/s"'
        problems.append(f'`overrides` "{text}": {message}')
    for (section, name), value in new.items():
        if section in CHOOSERS and name == CHOOSERS[section]:
            tables[section] = _switched(tables.get(section), section, value, path is None)
    if path is None and not _is_per_width(tables):  # Table 1 is per unit width
        for key in PER_WIDTH & tables["support"].keys():
            del tables["support"][key]
    for (section, name), value in new.items():
        table = tables.setdefault(section, {})
        if not isinstance(table, dict):
            continue
        for other in _excluded(section, name, table):
            if (section, other) not in new or section == "drive":
                table.pop(other, None)
        try:
            listed = (section, name) in LISTS or value.startswith("[")
            table[name] = tomllib.loads(f"v = {value}")["v"] if listed else value
        except (ValueError, RecursionError):
            table[name] = value
    return tables, problems


def _excluded(section: str, name: str, table: Mapping[str, Any]) -> list[str]:
    """Return the keys of a table that a new one replaces."""
    if section == "foundation" and name == "wlf":
        return ["activation_energy"]
    if section in ("foundation", "start"):
        specs = quantities(Foundation if section == "foundation" else Start)
        return list(specs[name].excludes) if name in specs else []
    if section == "support" and name in DEPTHS and name not in table:
        return [key for key in DEPTHS if key in table]
    if section == "drive" and name in DRIVES and name not in table:
        wave = WAVEFORMS.get(str(table.get("waveform")))
        if wave is None or name not in quantities(wave):  # another motion, on the same spring
            return [key for key in table if key not in SPRING]
    return []


def _switched(old: Any, section: str, choice: str, table1: bool) -> dict[str, Any]:
    """Return a section for another model, with the keys that it shares with the old one, or with Table 1."""
    meant = closest(choice, MODELS[section])
    names = _keys(MODELS[section][meant]) if meant else ()
    built_in = _tables(Scene.table1(choice))[section] if table1 and choice in SUPPORTS else {}
    common = {k: v for k, v in old.items() if k in names} if isinstance(old, dict) else {}
    return {**built_in, **common, CHOOSERS[section]: choice}


def _is_per_width(tables: Mapping[str, Any]) -> bool:
    """Whether the forces on the indenter are per unit width: for every shape except a ball."""
    indenter = tables.get("indenter")
    shape = indenter.get("shape") if isinstance(indenter, dict) else None
    return not isinstance(shape, str) or getattr(SHAPES.get(shape), "per_width", True)


def _part(section: str, table: Any, per_width: bool) -> Any:
    """Make one part of a scene from its table."""
    if not isinstance(table, dict):
        message = f"expected one table with this name, not {type(table).__name__}"
        raise SceneError([f"[{section}]: {message}"])
    chooser, models = CHOOSERS.get(section), MODELS[section]
    if section == "drive" and "waveform" in table:
        chooser, models = "waveform", WAVEFORMS
    name = table.get(chooser, DEFAULTS.get(section))
    rest = {key: value for key, value in table.items() if key != chooser}
    if isinstance(name, str) and name in models:
        choice = f'{chooser} = "{name}"' if chooser else ""
        return _made(models[name], section, rest, per_width, choice)
    problems = Problems()
    if chooser in table:
        one = f"expected exactly one of: {', '.join(models)}"
        what = nearest(name, models) if isinstance(name, str) else one
        problems.add(f"{section}.{chooser}", name, what)
    elif chooser is not None and absent([chooser], table):
        problems.append(f"{section}.{chooser}: missing; expected one of: {', '.join(models)}")
    meant = closest(name, models) if isinstance(name, str) else None
    if meant is not None:
        with problems.catching(section, table):
            _made(models[meant], section, rest, per_width, f'{chooser} = "{meant}"')
    elif chooser is not None:
        valid = [chooser, *dict.fromkeys(key for model in models.values() for key in _keys(model))]
        for key in [key for key in rest if key not in valid]:
            problems.add(f"{section}.{key}", rest[key], f"unknown key; {nearest(key, valid)}")
    raise SceneError(problems)


def _made(cls: Any, section: str, table: Mapping[str, Any], per_width: bool, choice: str) -> Any:
    """Make a part of a scene from the keys of its model; a waveform also takes those of a spring."""
    specs, valid, of = quantities(cls), _keys(cls), f" for {choice}" if choice else ""
    unknown = [key for key in table if key not in valid]
    misspelt = {closest(key, valid) for key in unknown}
    needed = required(cls, (*table, *["history"] * ("file" in table)))
    problems, found = Problems(), Problems()
    for name in needed:
        if name not in misspelt:
            spec = specs[name].fitting(per_width)
            ball = BALL if spec != specs[name] else ""
            problems.append(missing(section, name, spec, of + ball))
    for key in unknown:
        message = f"unknown key{of}; {_hint(section, key, valid)}"
        problems.add(f"{section}.{key}", table[key], message)
    values = {key: _unitless(table[key]) for key in valid if key in table}
    values |= dict.fromkeys(needed)
    if not per_width:
        for name, spec in {
            **quantities(cls),
            **(quantities(Drive) if section == "drive" else {}),
        }.items():
            if spec.per_width and values.get(name) is not None:
                values[name] = _of_ball(problems, f"{section}.{name}", values[name], spec)
    made = None
    if "file" in values:
        path = Path(str(values.pop("file")))
        if "history" in values:
            found.add(f"{section}.file", str(path), f"cannot be given beside {section}.history")
        values["history"] = [(0.0, 1.0)]
        with found.catching(section, table):
            values["history"] = (history_from if cls is Drive else depths_from)(path)
    waveform = cls in WAVEFORMS.values()
    spring = {key: values.pop(key) for key in SPRING if waveform and key in values}
    with found.catching(section, table):
        made = cls(**values)
    for key, array in {} if made is None else made.arrays().items():
        if not array.size:
            found.add(f"{section}.{key}", [], "is empty; expected at least one value")
    if waveform:
        with found.catching(section, table):
            made = Drive(velocity=0.0 if made is None else None, waveform=made, **spring)
    reported = [f"{section}.{name}: missing" for name in {*needed, *misspelt}]
    if misspelt & set(DRIVES):
        reported.append("drive: ")
    problems += [
        message.replace(": missing;", f": missing{of};", 1)
        for message in found
        if not message.startswith(tuple(reported))
    ]
    problems.report()
    return made


def _of_ball(problems: Problems, key: str, value: Any, spec: Quantity) -> Any:
    """Return a value of a ball; one that is not even per unit width is a mistake, and 1 in its place."""
    with suppress(ValueError):
        converted(value, spec)
        return value  # `inconsistencies` says that a ball has a total instead
    with problems.catching(key, value):
        converted(value, spec.fitting(False))
        return value
    return 1.0


def _hint(section: str, key: str, valid: list[str]) -> str:
    """Return which other models of a section have this key or a synonym, or else a similar key."""
    known = [CHOOSERS[section], *valid] if section in CHOOSERS else valid
    keys = {name: _keys(model) for name, model in MODELS[section].items()}
    meant = key if any(key in own for own in keys.values()) else MEANT.get(key, "")
    having = [f'"{name}"' for name, own in keys.items() if meant in own]
    if not having or section not in CHOOSERS or {MEANT.get(key, key), ELSE.get(key)} & set(known):
        return nearest(key, known)
    return f"{meant} is of {CHOOSERS[section]} = {' or '.join(having)}"


def _unitless(value: Any) -> Any:
    """Return the value of a key with its numbers as texts, so that a missing unit is reported."""
    if isinstance(value, list):
        return [_unitless(item) for item in value]
    if isinstance(value, bool) or not isinstance(value, int | float):
        return value
    return Bare("inf" if value > LARGEST else repr(value))


def _keys(cls: Any) -> list[str]:
    """Return the keys of a model: its quantities, and its other keys, such as lists of pairs."""
    lists: tuple[str, ...] = DRIVES if cls is Drive else ()
    if cls in FOUNDATIONS.values():
        lists = ("wlf", "shift_factors", "stiffness_from", *["arms"] * (cls is GeneralizedMaxwell))
    elif cls in WAVEFORMS.values():
        lists = SPRING
    elif cls is Fixed:
        lists = DEPTHS
    return list(dict.fromkeys((*quantities(cls), *lists)))
