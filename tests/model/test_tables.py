"""The text and the HTML of a result are tables of the fields of the result."""

from dataclasses import dataclass

from hybrid_tamp.model.predicate import Atom
from hybrid_tamp.model.tables import Tabular


@dataclass(frozen=True)
class Weather(Tabular):
    """A result."""

    wind_speed: float
    dry: bool
    goal: tuple[Atom, ...]
    figures: dict[str, float]
    remark: str | None = None


WEATHER = Weather(3.14159, True, (Atom("inside", ("<drum>", "goal")), Atom("empty", ("hand",))), {"a": 1.0, "b": 2.5})


def test_text_is_a_table_of_the_fields() -> None:
    assert str(WEATHER).splitlines() == [
        "wind speed  3.142",
        "dry         yes",
        "goal        inside(<drum>, goal)",
        "            empty(hand)",
        "figures     a: 1",
        "            b: 2.5",
        "remark      none",
    ]


def test_html_is_the_same_table_escaped() -> None:
    html = WEATHER._repr_html_()
    assert html.startswith("<table><tr><th>wind speed</th><td>3.142</td></tr>")
    assert "<td>inside(&lt;drum&gt;, goal)<br>empty(hand)</td>" in html
    assert "<drum>" not in html


def test_the_representation_stays_that_of_a_dataclass() -> None:
    assert repr(Weather(1.0, False, (), {})) == "Weather(wind_speed=1.0, dry=False, goal=(), figures={}, remark=None)"
