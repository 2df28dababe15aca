"""Translate errors of the YAML parser to faults with places."""

import re

from ruamel.yaml.error import MarkedYAMLError
from ruamel.yaml.reader import ReaderError

from hybrid_tamp.taskfile.places import Faults, Mark, cut, mark_of, shown

_LINE_END = re.compile("\r\n|\r|\n")
_TAB_IN_INDENTATION = re.compile(r" *\t")
_END = "unexpected end of stream"
_WANTED = (
    ("mapping values are not allowed", "a line must have only one key, and text with ': ' must be in quotes"),
    ("expected ',' or ']'", "expected a comma or ']' in a list"),
    ("expected ',' or '}'", "expected a comma or '}' in a mapping"),
    (_END, "a text in quotes must have a closing quote"),
    ("could not find expected ':'", "a key must be followed by ':'"),
    ("expected <block end>", "the lines of a list or mapping must have the same indentation"),
    ("unknown escape character", "YAML does not know this escape in double quotes; use single quotes for plain text"),
    ("undefined tag handle", "a task file must not contain tags"),
    ("cannot start any token", "text that begins with this character must be in quotes"),
)


def add_syntax_fault(faults: Faults, text: str, error: Exception, last: Mark) -> None:
    """Record why a text is not YAML. Also record all later tabs in indentations.

    Args:
        faults: the faults to which the new faults are added.
        text: the whole text.
        error: the error that the parser raised.
        last: the place of the last event, which is reported if the error has no place.
    """
    if isinstance(error, ReaderError):
        remedy = "remove the character, or write an escape in double quotes"
        came = f"the control character U+{error.character:04X}"
        faults.add(mark_of(text, error.position), "a task file must be printable text", came, remedy=remedy)
        return
    mark, problem = last, "cannot read the text after this place"
    if isinstance(error, MarkedYAMLError):
        problem = str(error.problem or error.context or problem)
        place = (error.context_mark if _END in problem else None) or error.problem_mark or error.context_mark
        mark = Mark(place.line + 1, place.column + 1) if place else last
    lines = _LINE_END.split(text)
    line = lines[mark.line - 1] if mark.line <= len(lines) else ""
    if line[mark.column - 1 : mark.column] == "\t" or _TAB_IN_INDENTATION.match(line):
        _add_tabs(faults, lines, mark)
        return
    wanted = next((wanted for part, wanted in _WANTED if part in problem), f"not valid YAML 1.2: {cut(problem)}")
    faults.add(mark, wanted, shown(line.strip()))


def _add_tabs(faults: Faults, lines: list[str], first: Mark) -> None:
    tabs = ((number, _TAB_IN_INDENTATION.match(line)) for number, line in enumerate(lines, start=1))
    for place in {first, *(Mark(number, tab.end()) for number, tab in tabs if tab and number > first.line)}:
        faults.add(place, "lines must be indented with spaces", "a tab", remedy="replace the tab by spaces")
