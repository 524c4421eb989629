"""The page of what works with what, from the table of the code."""

from kvtheory.scene.capabilities import DRIVES, LAWS, QUESTIONS, SHAPES, SUPPORTS, Needs

SHORT = dict(zip(LAWS, ("KV", "Prony", "both", "springpot"), strict=True))
_HEAD = """# What works with what

A scene has an indenter shape, a law of the foundation (KV: `kelvin-voigt`, Prony: `generalized-maxwell`,
both: the same with `damping`, springpot: `fractional-kelvin-voigt`; all: these four), a support and a
drive. Each row is a question, each cell lists the laws on which it is answered for a shape, with any support
and any drive unless a remark restricts them. A cell is empty where theory is missing.
The messages of the functions come from the same table."""


def pages() -> dict[str, str]:
    """Return the page."""
    head = [f"| question | {' | '.join(SHAPES.values())} |", f"|---|{'---|' * len(SHAPES)}"]
    rows = [
        f"| {row.what}<br>`{row.call}` | {' | '.join(_cell(row.needs, shape) for shape in SHAPES)} |"
        for row in QUESTIONS.values()
    ]
    why = [
        f"**{row.what[0].upper()}{row.what[1:]}.** {row.missing}"
        for row in QUESTIONS.values()
        if row.missing
    ]
    parts = [_HEAD, "\n".join(head + rows), "## What is missing", "\n\n".join(why)]
    return {"what-works.md": "\n\n".join(parts) + "\n"}


def _cell(needs: Needs, shape: str) -> str:
    """Return the laws on which a question is answered for a shape, with the supports and drives it needs."""
    found: dict[tuple[str, ...], list[str]] = {}
    for law in LAWS:
        pairs = [(s, d) for s in SUPPORTS for d in DRIVES if law in needs.laws(shape, s, d)]
        supports = [s for s in SUPPORTS if any(s == support for support, _ in pairs)]
        drives = [d for d in DRIVES if any(d == drive for _, drive in pairs)]
        told = [f"support {', '.join(supports)}"] if len(supports) < len(SUPPORTS) else []
        told += [f"{', '.join(drives)} drive"] if len(drives) < len(DRIVES) else []
        if pairs:
            found.setdefault(tuple(told), []).append(SHORT[law])
    return "; ".join(_told(laws, told) for told, laws in found.items())


def _told(laws: list[str], remarks: tuple[str, ...]) -> str:
    named = "all" if len(laws) == len(LAWS) else ", ".join(laws)
    return named + (f" ({'; '.join(remarks)})" if remarks else "")
