"""Reference problems: named scenes for testing a method or a simulator."""

from kvtheory.reference_problems.named import problem, problem_text, problems

__all__ = ["problem", "problem_text", "problems"]
