"""The reference of the Python interface, from signatures and docstrings."""

import dataclasses
import inspect
import re
import textwrap

from kvtheory.derivations.catalogue import CONTENTS

import kvtheory as kv
from generators.labels import linked

SECTION = re.compile(r"^([A-Z]\w+(?: \w+)?)\n-{3,}\n", re.MULTILINE)
GROUPS = {
    "kvtheory.api": "Compute",
    "kvtheory.scene": "Scenes",
    "kvtheory.scene.model.Scene": "Scenes",
    "kvtheory.scene.model.Run": "Scenes",
    "kvtheory.reference_problems": "Scenes",
    "kvtheory.scene.indenters": "Indenters",
    "kvtheory.scene.foundations": "Foundations",
    "kvtheory.scene.model": "Supports",
    "kvtheory.scene.drives": "Drives",
    "kvtheory.scene.waveforms": "Drives",
    "kvtheory.results": "Results",
    "kvtheory.results.errors.Certificate": "Results",
    "kvtheory.results.errors": "Errors",
    "kvtheory.scene.mistakes.SceneError": "Errors",
}
"""Headings of the public names, by the name itself, its module or its package."""


def pages() -> dict[str, str]:
    """Return a page for each public name, and their index."""
    texts = {f"api/{name}.md": _page(name) for name in kv.__all__}
    groups: dict[str, list[str]] = {title: [] for title in GROUPS.values()}
    for name in kv.__all__:
        groups[_group(name)].append(name)
    parts = ["# Python interface", "`import kvtheory as kv`; each name is `kv.NAME`."]
    for title, names in groups.items():
        rows = "\n".join(f"- [`{name}`]({name}.md): {_first(getattr(kv, name))}" for name in names)
        tree = "\n".join(names)
        parts.append(f"## {title}\n\n{rows}\n\n```{{toctree}}\n:hidden:\n\n{tree}\n```")
    texts["api/index.md"] = "\n\n".join(parts) + "\n"
    return texts


def _group(name: str) -> str:
    """Return the heading of a public name."""
    module = getattr(kv, name).__module__
    places = (f"{module}.{name}", module, module.rpartition(".")[0])
    return next(GROUPS[place] for place in places if place in GROUPS)


def _page(name: str) -> str:
    thing = getattr(kv, name)
    kind = "class" if inspect.isclass(thing) else "function"
    if kind == "class" and issubclass(thing, Exception):
        kind = "exception"
    text = [f"# {name}", _entry(kind, f"kvtheory.{name}{_signature(thing)}", thing, ":" * 5)]
    return "\n\n".join(text) + "\n"


def _entry(kind: str, signature: str, thing: object, fence: str) -> str:
    """Return a directive of the Python domain with its docstring, and the members of a class."""
    body = [prose(inspect.getdoc(thing) or "")]
    if kind == "class":
        if fields := _fields(thing):
            body.append(fields)
        shared = [
            cls for cls in thing.__mro__[1:] if cls.__module__.startswith("kvtheory.results.")
        ]
        members = {k: v for cls in [*reversed(shared), thing] for k, v in vars(cls).items()}
        for name, member in members.items():
            function = (
                member.__func__ if isinstance(member, (classmethod, staticmethod)) else member
            )
            if name.startswith("_") or not inspect.getdoc(function):
                continue
            if inspect.isfunction(function):
                body.append(_entry("method", f"{name}{_signature(function)}", function, fence[:-1]))
            elif isinstance(member, property):
                body.append(_entry("property", name, member, fence[:-1]))
    inside = "\n\n".join(part for part in body if part)
    if signature.partition("(")[0] in CONTENTS:  # also a label, to which links must lead
        inside = f":no-index:\n\n{inside}"
    return f"{fence}{{py:{kind}}} {signature}\n{inside}\n{fence}"


def _signature(thing: object) -> str:
    try:
        found = inspect.signature(thing)
    except (TypeError, ValueError):
        return ""
    names = [
        str(each.replace(annotation=each.empty, default=each.empty)) + _default(each)
        for each in found.parameters.values()
        if each.name != "self"
    ]
    return f"({', '.join(names)})"


def _default(parameter: inspect.Parameter) -> str:
    if parameter.default is parameter.empty:
        return ""
    shown = repr(parameter.default)
    return f"={shown}" if len(shown) < 30 and "<" not in shown else "=..."


def _fields(cls: type) -> str:
    """Return the quantities of a part of a scene, with units and ranges."""
    if not dataclasses.is_dataclass(cls):
        return ""
    rows = []
    for each in dataclasses.fields(cls):
        if spec := each.metadata.get("quantity"):
            rows.append(f"| `{each.name}` | {spec.unit} | {_cell(spec.doc)} | {spec.range} |")
    head = "| field | unit | meaning | range |\n|---|---|---|---|\n"
    return head + "\n".join(rows) if rows else ""


def _first(thing: object) -> str:
    return linked(escaped((inspect.getdoc(thing) or "").split("\n\n")[0].replace("\n", " ")))


def prose(docstring: str) -> str:
    """Return a docstring in the style of NumPy as Markdown."""
    parts = SECTION.split(docstring.strip())
    found = [_paragraphs(parts[0])]
    for title, body in zip(parts[1::2], parts[2::2], strict=True):
        listed = title in ("Parameters", "Returns", "Raises", "Attributes")
        content = _listed(body) if listed else _paragraphs(body)
        found.append(f"**{title}**\n\n{content}")
    return "\n\n".join(found)


def _paragraphs(text: str) -> str:
    """Return paragraphs as Markdown: examples and indented blocks as code, the rest as text."""
    blocks, parts = re.split(r"\n\s*\n", text.strip("\n")), []
    for block in filter(str.strip, blocks):
        if block.lstrip().startswith(">>>"):
            parts.append(f"```pycon\n{textwrap.dedent(block)}\n```")
        elif block.startswith("    "):
            parts.append(f"```text\n{textwrap.dedent(block)}\n```")
        else:
            words, _, example = block.partition("\n>>>")
            parts.append(linked(escaped(words)))
            if example:
                parts.append(f"```pycon\n>>>{example}\n```")
    return "\n\n".join(parts)


def _listed(body: str) -> str:
    """Return the entries of a section, such as parameters, as a list."""
    rows = []
    for block in re.split(r"\n(?=\S)", body.strip("\n")):
        head, _, rest = block.partition("\n")
        words = linked(escaped(textwrap.dedent(rest).replace("\n", " ").strip()))
        rows.append(
            f"- `{head.strip()}`: {words}" if words else f"- {linked(escaped(head.strip()))}"
        )
    return "\n".join(rows)


def escaped(text: str) -> str:
    """Return text with the special characters of Markdown escaped, except between backticks."""
    parts = re.split(r"(``[^`]*``|`[^`]*`)", text)
    return "".join(
        part if part.startswith("`") else re.sub(r"([\\*_<>\[\]$|{}#~^])", r"\\\1", part)
        for part in parts
    )


def _cell(text: str) -> str:
    return escaped(text).replace("|", r"\|") if "\\|" not in escaped(text) else escaped(text)
