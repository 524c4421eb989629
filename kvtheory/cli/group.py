"""The command `kvtheory`, to which the modules beside this one add theirs."""

import click


@click.group(context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="kvtheory")
def main() -> None:
    """Sliding friction of a rigid indenter on a Kelvin-Voigt foundation.

    Without a scene file, each command works on Table 1 of Nakano and Kono (2020) with a dead
    weight. Exit status: 0 done, 1 a check found disagreement, 2 bad input.
    """
