"""`kvtheory explore`: an interactive HTML page for a scene."""

from collections.abc import Sequence
from pathlib import Path

import click

from kvtheory.cli.console import Examples, progress_bar, report_errors, scene_options
from kvtheory.cli.group import main
from kvtheory.cli.outputs import check_output, overwrite_option, path_option


@main.command(cls=Examples, example="kvtheory explore my-scene.toml -o explorer.html")
@scene_options
@path_option(
    "-o", "--output", default=Path("explorer.html"), show_default=True,
    help="File to write; it needs no server and no network.",
)  # fmt: skip
@overwrite_option
@report_errors
def explore(scene: str | None, overrides: Sequence[str], output: Path) -> None:
    """Write one HTML page with a slider for every number of a scene, which shows steady sliding at once."""
    from kvtheory.explorer import save_explorer
    from kvtheory.scene import load_scene

    check_output("-o", output, [".html"])
    with progress_bar("explore"):
        checked = load_scene(scene, overrides)
        save_explorer(checked, output)
    click.echo(f"{output}: open it in any browser")
