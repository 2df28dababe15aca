import re

from hypothesis import example, given
from hypothesis import strategies as st

from hybrid_tamp.symbolic.pddl.naming import _KEYWORDS, Naming, legal

NASTY = ["2go-now?", "At Robot", "and", "ß", "Ball", "ball", "BALL", "", " ", "-", "a b", "a-b", "日本", "n-2go-now"]


@given(st.lists(st.text(max_size=12), unique=True), st.sets(st.sampled_from(["ball", "idle", "token"])))
@example(NASTY, set())
@example(["Ball", "ball", "ball-2", "and"], {"ball"})
def test_names_go_there_and_back(names: list[str], taken: set[str]) -> None:
    naming = Naming({name: name for name in names}, taken)
    for name in names:
        pddl = naming.pddl(name)
        assert re.fullmatch(r"[a-z][a-z0-9_-]*", pddl)
        assert pddl not in taken | _KEYWORDS
        assert naming.user(pddl) == name
        assert naming.user(pddl.upper()) == name
    assert len(naming.all) == len(names)


@given(st.permutations(NASTY))
def test_names_do_not_depend_on_the_order(names: list[str]) -> None:
    assert Naming({n: n for n in names}).changed == Naming({n: n for n in NASTY}).changed


def test_legal_names_keep_themselves() -> None:
    assert Naming({n: n for n in ("drum", "hand_2", "goal-a")}).changed == ()
    assert Naming({"Drum": "Drum", "drum": "drum"}).pddl("drum") == "drum"
    assert legal("STATIC END-EFFECTOR") == "static-end-effector"
