"""The width and height of frames."""

import re

from hybrid_tamp.errors import InputError, Issue

SIZE = (1280, 720)
"""Default width and height of frames [pixels]."""
SMALLEST, LARGEST = (320, 240), (7680, 4320)


def parse_size(text: str) -> tuple[int, int]:
    """Return the width and height [pixels] from a text such as ``1920x1080``.

    Raises:
        InputError: the text has another form, or pictures cannot have this size.
    """
    found = re.fullmatch(r"([0-9]{1,9})x([0-9]{1,9})", text.strip(), re.ASCII)
    if found is None:
        raise InputError([Issue("--size", "expected a width and a height, e.g. 1920x1080", repr(text))])
    size = (int(found[1]), int(found[2]))
    check_size(size)
    return size


def check_size(size: tuple[int, int]) -> None:
    """Raise `InputError` if pictures cannot have this width and height [pixels]."""
    width, height = size
    small = any(one < least for one, least in zip(size, SMALLEST, strict=True))
    large = any(one > most for one, most in zip(size, LARGEST, strict=True))
    if small or large or width % 2 or height % 2:
        least, most = (f"{one}x{other}" for one, other in (SMALLEST, LARGEST))
        wanted = f"the width and the height of pictures must be even numbers between {least} and {most}"
        raise InputError([Issue("size", wanted, f"{width}x{height}")])
