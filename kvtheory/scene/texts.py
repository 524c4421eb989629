"""Text files in the encodings in which shells and spreadsheets write them."""

import codecs
from pathlib import Path

MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
"""Byte order marks, by which a file tells its encoding."""


def read_text(path: Path) -> str:
    r"""Return the text of a file in UTF-8, UTF-16 (of a Windows shell) or Windows-1252 (of Excel).

    UTF-16 is recognised by its mark or by the zeros between its letters. Text that is not UTF-8 is read as
    Windows-1252, in which all letters of units have the same codes as in Latin-1.

    Raises
    ------
    UnicodeDecodeError
        If it is none of these.
    OSError
        If it cannot be read.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "scene.toml"
    >>> for encoding in ("utf-8", "utf-16", "utf-16-le", "latin-1"):
    ...     _ = path.write_text('radius = "5 µm"', encoding=encoding)
    ...     assert read_text(path) == 'radius = "5 µm"'
    """
    data = path.read_bytes()
    encodings = [name for mark, name in MARKS.items() if data.startswith(mark)]
    if not encodings and b"\0" in data[:2]:
        encodings = ["utf-16-be" if data.startswith(b"\0") else "utf-16-le"]
    try:
        text = data.decode(encodings[0] if encodings else "utf-8")
    except UnicodeDecodeError:
        if encodings:
            raise
        text = data.decode("cp1252")
    return text.replace("\r\n", "\n")
