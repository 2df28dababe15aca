"""The figures in docs/figures.md exist, and the page has the command that draws each of them."""

import re

from contracts.imports import ROOT
from PIL import Image

PAGE = (ROOT / "docs" / "figures.md").read_text(encoding="utf-8")
FIGURES = [ROOT / "docs" / name for name in re.findall(r"!\[[^\]]+\]\(([^)]+)\)", PAGE)]
COMMANDS = [line for block in re.findall(r"```sh\n(.*?)```", PAGE, re.DOTALL) for line in block.splitlines()]


def test_every_figure_is_a_picture() -> None:
    assert FIGURES
    for figure in FIGURES:
        if figure.suffix in (".png", ".gif"):
            with Image.open(figure) as picture:
                picture.load()


def test_the_page_has_the_command_of_every_figure() -> None:
    text = "\n".join(COMMANDS)
    for figure in FIGURES:
        assert figure.name in text or f"scripts/{figure.stem}" in text, figure.name


def test_animated_figures_move_and_have_at_most_3_mb_in_all() -> None:
    animated = [figure for figure in FIGURES if figure.suffix == ".gif"]
    assert len(animated) >= 2
    assert sum(figure.stat().st_size for figure in animated) < 3_000_000
    for figure in animated:
        with Image.open(figure) as picture:
            assert getattr(picture, "n_frames", 1) > 20
            assert picture.info["loop"] == 0
