"""x"""
from ..engine.chapter import Chapter
result = Chapter("Layer")
