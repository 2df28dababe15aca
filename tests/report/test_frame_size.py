"""Tests of the size of pictures."""

import pytest

from hybrid_tamp.errors import InputError
from hybrid_tamp.report.frame_size import SIZE, check_size, parse_size


def test_size_is_read_from_its_text() -> None:
    assert parse_size("1920x1080") == (1920, 1080)
    assert parse_size(" 640x360 ") == (640, 360)
    assert parse_size("x".join(map(str, SIZE))) == SIZE


@pytest.mark.parametrize(
    "text", ["", "720", "1280X720", "1280 x 720", "-1280x720", "1e3x720", "1280x720x3", "1280.0x720"]
)
def test_text_of_another_form_is_refused_with_an_example(text: str) -> None:
    with pytest.raises(InputError, match=r"e\.g\. 1920x1080"):
        parse_size(text)


@pytest.mark.parametrize("text", ["0x0", "318x240", "320x238", "1281x720", "1280x721", "7682x1000", "999999999x720"])
def test_size_out_of_bounds_or_odd_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="even numbers between 320x240 and 7680x4320"):
        parse_size(text)


def test_bounds_are_allowed() -> None:
    check_size((320, 240))
    check_size((7680, 4320))
