"""Reference problems: named scenes that a method, or somebody's simulator, can be judged by."""

from kvtheory.reference_problems.named import problem, problem_text, problems

__all__ = ["problem", "problem_text", "problems"]
