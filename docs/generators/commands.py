"""The reference of the commands: the help of each, and the output of its example."""

import shlex
import tempfile
from contextlib import chdir
from pathlib import Path

import click
from click.testing import CliRunner

from kvtheory.cli import main

SHOWN = {
    "scene": 'kvtheory scene --set drive.velocity="50 mm/s"',
    "steady": 'kvtheory steady --set drive.velocity="50 mm/s"',
    "asymptotes": "kvtheory asymptotes --tolerance 0.01",
    "transient": 'kvtheory transient --at "0 ms,1 ms,10 ms,200 ms"',
    "elements": 'kvtheory elements --at "0 ms,1 ms,10 ms" --per-length "20 /mm"',
    "solve": "kvtheory solve --quantity friction_coefficient --rtol 0.01 --explain",
    "sweep": 'kvtheory sweep --over "drive.velocity=10 mm/s:1 m/s:3:log" -o map.csv',
    "explore": "kvtheory explore -o explorer.html",
    "cite": "kvtheory cite",
}
"""Examples that are run to show their output; other commands are shown by their help alone."""


def pages() -> dict[str, str]:
    """Return one page about all commands."""
    parts = ["# Commands", _HEAD]
    for name, command in sorted(main.commands.items()):
        parts += _section(name, command, [name])
    return {"commands.md": "\n\n".join(parts) + "\n"}


def _section(name: str, command: click.Command, path: list[str]) -> list[str]:
    title = " ".join(["kvtheory", *path])
    parts = [f"## {title}", f"```text\n{_run([*path, '--help'])}\n```"]
    if isinstance(command, click.Group):
        for child, own in sorted(command.commands.items()):
            parts += _section(child, own, [*path, child])
    if name in SHOWN:
        parts.append(f"```console\n$ {SHOWN[name]}\n{_run(shlex.split(SHOWN[name])[1:])}\n```")
    return parts


def _run(arguments: list[str]) -> str:
    with tempfile.TemporaryDirectory() as directory, chdir(Path(directory)):
        done = CliRunner().invoke(main, arguments, prog_name="kvtheory", terminal_width=88)
    if done.exit_code:
        raise RuntimeError(f"kvtheory {shlex.join(arguments)}: {done.output}")
    return done.output.rstrip()


_HEAD = """Every command takes an optional scene file; without one it works on Table 1 of the paper with a
dead weight. `--set KEY=VALUE` changes a key of the scene, and `--json` prints one JSON object in SI units.
The outputs below were made together with this page. See also [exit status](../reference/exit-status.md)."""
