"""The command line, run in the process of the tests, and Python in one of its own."""

import json
import subprocess
import sys
from pathlib import Path

from click.testing import CliRunner

from kvtheory.cli import main


def run(*arguments, status=0):
    """Run a command, which has to end with this status and without a traceback; return its result."""
    result = CliRunner().invoke(main, [str(each) for each in arguments])
    assert result.exit_code == status, result.output
    assert "Traceback" not in result.output or status == 70
    return result


def printed(*arguments, status=0):
    """Return the JSON object that a command prints."""
    return json.loads(run(*arguments, "--json", status=status).stdout)


def python(*arguments, cwd=Path(__file__).parents[1]):
    """Run Python, which has to end well and without a warning; return what it prints."""
    call = [sys.executable, "-W", "error", *map(str, arguments)]
    done = subprocess.run(call, capture_output=True, text=True, check=False, cwd=cwd)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def refused(arguments, words):
    """Run a command with a mistake in its input; return its message, which has to hold these words."""
    result = run(*arguments, status=2)
    assert result.stdout == ""
    assert all(word in result.stderr for word in words), result.stderr
    return result.stderr
