"""Lists in a text, as options and quantities give them."""


def split(text: str) -> list[str]:
    """Return the items of a text with commas between; an empty one raises `ValueError`.

    >>> split("depth, load")
    ['depth', 'load']
    """
    items = [item.strip() for item in text.split(",")]
    if not all(items):
        where = f"item {items.index('') + 1} of the list" if any(items) else "the list"
        raise ValueError(f"{where} is empty; expected at least one item, and one comma between two")
    return items
