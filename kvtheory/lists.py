"""Lists in a text, as options and quantities give them."""


def split(text: str) -> list[str]:
    """Return the items of a text with commas between; an empty one raises `ValueError`.

    >>> split("depth, load")
    ['depth', 'load']
    """
    items = [item.strip() for item in text.split(",")]
    if not all(items):
        where = "is empty" if not any(items) else f"item {items.index('') + 1} is empty"
        raise ValueError(f"{where}; expected at least one item, and one comma between two")
    return items
