"""Text for people."""

from __future__ import annotations


def escaped(text: str) -> str:
    """For HTML."""
    import html

    return html.escape(text)


class Text(str):
    """A text of several lines that a prompt or a notebook shows as `print` does."""

    __slots__ = ()

    def __repr__(self) -> str:
        return str(self)

    def _repr_html_(self) -> str:
        return f"<pre>{escaped(self)}</pre>"
