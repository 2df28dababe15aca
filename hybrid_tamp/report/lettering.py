"""Letters for pictures: the width of texts and their division into lines."""

from dataclasses import dataclass
from functools import cached_property

from PIL import ImageFont


@dataclass(frozen=True)
class Letters:
    """Letters of one size.

    Attributes:
        size: height of the letters [pixels].
    """

    size: int

    @cached_property
    def font(self) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
        """Font with letters of this size."""
        return ImageFont.load_default(self.size)

    @property
    def line(self) -> int:
        """Distance between lines [pixels]."""
        return round(1.36 * self.size)

    def width(self, text: str) -> float:
        """Return the width of a text [pixels]."""
        return self.font.getlength(text)

    def cut(self, text: str, room: float) -> str:
        """Return the text, shortened with dots if it is wider than the room [pixels]."""
        if self.width(text) <= room:
            return text
        while text and self.width(f"{text}...") > room:
            text = text[:-1]
        return f"{text}..."

    def wrap(self, text: str, room: float) -> list[str]:
        """Break a text into lines that fit the room [pixels]. Break only words that are wider than a line."""
        lines = [""]
        for word in text.split(" "):
            longer = f"{lines[-1]} {word}" if lines[-1] else word
            if self.width(longer) <= room:
                lines[-1] = longer
                continue
            lines = [*(lines if lines[-1] else lines[:-1]), *self._pieces(word, room)]
        return lines

    def _pieces(self, word: str, room: float) -> list[str]:
        pieces = [""]
        for letter in word:
            if self.width(pieces[-1] + letter) > room and pieces[-1]:
                pieces.append("")
            pieces[-1] += letter
        return pieces
