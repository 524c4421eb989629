"""Text files in the encodings in which shells and spreadsheets write them."""

import codecs
import errno
import os
import stat
from pathlib import Path

MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
"""Byte order marks, by which a file tells its encoding."""
MOST = 2**28
"""Bytes of a text; a million rows of ten columns are fewer."""


def read_text(path: Path) -> str:
    r"""Return the text of a file in UTF-8, UTF-16 (of a Windows shell) or Windows-1252 (of Excel).

    UTF-16 is recognised by its mark or by the zeros between its letters. Text that is not UTF-8 is read as
    Windows-1252, in which all letters of units have the same codes as in Latin-1.

    Raises
    ------
    UnicodeDecodeError
        If it is none of these.
    OSError
        If it cannot be read, is a device, or holds more than `MOST` bytes.

    Examples
    --------
    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "scene.toml"
    >>> for encoding in ("utf-8", "utf-16", "utf-16-le", "latin-1"):
    ...     _ = path.write_text('radius = "5 µm"', encoding=encoding)
    ...     assert read_text(path) == 'radius = "5 µm"'
    """
    with path.open("rb") as file:
        if stat.S_ISCHR(os.fstat(file.fileno()).st_mode):
            raise OSError(errno.EINVAL, "is a device; expected a file", str(path))
        data = file.read(MOST + 1)
    if len(data) > MOST:
        told = f"holds more than {MOST / 1e6:.0f} MB, the most that is read"
        raise OSError(errno.EFBIG, told, str(path))
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
