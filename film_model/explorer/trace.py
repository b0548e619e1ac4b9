"""Formulas of this package written as JavaScript: they are called once, with symbols in place of numbers.

Formulas that serve one impact and many take arrays. :class:`Symbol` is an array of one unknown number that records
what is done to it. Where a formula asks whether a condition holds for any of many impacts, the answer is yes, and for
all, no: the recorded formula is the general one, which serves every impact.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np

_BINARY: dict[Any, str] = {
    **{np.add: "{} + {}", np.subtract: "{} - {}", np.multiply: "{} * {}", np.true_divide: "{} / {}"},
    **{np.less: "{} < {}", np.less_equal: "{} <= {}", np.greater: "{} > {}", np.greater_equal: "{} >= {}"},
    **{np.equal: "{} === {}", np.not_equal: "{} !== {}"},
    **{np.bitwise_and: "{} && {}", np.logical_and: "{} && {}", np.bitwise_or: "{} || {}", np.logical_or: "{} || {}"},
    **{np.minimum: "{1} < {0} ? {1} : {0}", np.maximum: "{1} > {0} ? {1} : {0}", np.power: "Math.pow({}, {})"},
    **{np.arctan2: "Math.atan2({}, {})", np.floor_divide: "Math.floor({} / {})"},
}
_UNARY: dict[Any, str] = {
    **{np.negative: "-{}", np.positive: "{}", np.absolute: "Math.abs({})", np.sqrt: "Math.sqrt({})"},
    **{np.isnan: "Number.isNaN({})", np.invert: "!{}", np.logical_not: "!{}", np.log: "Math.log({})"},
    **{np.square: "{0} * {0}", np.exp: "Math.exp({})", np.expm1: "Math.expm1({})"},
    **{np.cos: "Math.cos({})", np.sin: "Math.sin({})", np.arctan: "Math.atan({})"},
}
_FORMS = _BINARY | _UNARY
_NAME, _PLACE = re.compile(r"t\d+"), re.compile(r"{(\d)}")


class Symbol(np.ndarray):
    """An unknown number. index: of its expression in the recording."""

    index: int
    recording: Recording

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **kwargs: Any) -> Any:
        if method != "__call__" or kwargs or ufunc not in _FORMS:
            return NotImplemented
        return self.recording.add(_FORMS[ufunc], inputs)

    def __array_function__(self, func: Any, types: Any, args: Any, kwargs: Any) -> Any:
        if func is np.where and not kwargs:
            return self.recording.add("{} ? {} : {}", args)
        if func is np.any or func is np.all:
            return func is np.any
        if func is np.count_nonzero:
            return 0.5  # neither none nor all: the condition may hold or not
        return NotImplemented

    def __pow__(self, other: Any, modulo: None = None) -> Any:  # NumPy's power would replace x**0.5 by a square root
        return self.recording.add("Math.pow({}, {})", (self, other))

    def __rpow__(self, other: Any, modulo: None = None) -> Any:
        return self.recording.add("Math.pow({}, {})", (other, self))

    def __ceil__(self) -> Any:
        return self.recording.add("Math.ceil({})", (self,))

    def any(self, *args: Any, **kwargs: Any) -> Any:
        return True

    def all(self, *args: Any, **kwargs: Any) -> Any:
        return False

    def __getitem__(self, place: Any) -> Any:
        return self

    def __bool__(self) -> bool:
        """The check that an input is positive and finite counts as passed; other questions have no answer."""
        if not self.recording.is_range_check(self.index):
            raise TypeError("this formula asks whether a condition holds")
        return True

    def __float__(self) -> float:
        raise TypeError("this formula takes numbers only")


class Recording:
    """Expressions in the order in which they were recorded, each of them once."""

    def __init__(self) -> None:
        self._expressions: list[tuple[str, tuple[str, ...]]] = []
        self._known: dict[tuple[str, tuple[str, ...]], int] = {}

    def symbol(self, text: str) -> Symbol:
        """An input, by its JavaScript expression."""
        return self._made(text, ())

    def symbols(self, owner: str, names: Any) -> dict[str, Symbol]:
        """Inputs that are properties of an object, by name."""
        return {name: self.symbol(f'{owner}["{name}"]') for name in names}

    def add(self, form: str, inputs: tuple[Any, ...]) -> Symbol:
        """Record an operation."""
        return self._made(form, tuple(self._text(value) for value in inputs))

    def is_range_check(self, index: int) -> bool:
        """Whether an expression compares a value with 0 or with infinity."""
        form, inputs = self._expressions[index]
        return form in ("{} < {}", "{} > {}") and any(text in ("0.0", "Infinity") for text in inputs)

    def _made(self, form: str, inputs: tuple[str, ...]) -> Symbol:
        key = form, inputs
        if key not in self._known:
            self._known[key] = len(self._expressions)
            self._expressions.append(key)
        made = np.full(1, np.nan).view(Symbol)
        made.index, made.recording = self._known[key], self
        return made

    def _text(self, value: Any) -> str:
        if isinstance(value, Symbol):
            return f"t{value.index}"
        if value is None:
            return "null"
        if isinstance(value, bool | np.bool_):
            return "true" if value else "false"
        number = float(np.asarray(value).item())
        if not math.isfinite(number):
            return "NaN" if number != number else "Infinity" if number > 0.0 else "-Infinity"
        return f"({number!r})" if math.copysign(1.0, number) < 0.0 else repr(number)

    def function(self, name: str, arguments: str, outputs: Mapping[str, Any]) -> str:
        """A JavaScript function that returns an object with these values; what is used once stands where it is used."""
        texts = {key: self._text(value) for key, value in outputs.items()}
        uses = self._uses(list(texts.values()))
        written, lines = dict[str, str](), list[str]()
        for index, (form, inputs) in enumerate(self._expressions):
            here = f"t{index}"
            if here not in uses:
                continue
            text = form.format(*(written.get(text, text) for text in inputs))
            if uses[here] > 1 and inputs:
                written[here] = f"t{len(lines)}"
                lines.append(f"  const {written[here]} = {text};")
            else:
                written[here] = f"({text})" if " " in form and not form.startswith("Math.") else text
        result = ", ".join(f"{key}: {written.get(text, text)}" for key, text in texts.items())
        return "\n".join([f"function {name}({arguments}) {{", *lines, f"  return {{ {result} }};", "}"])

    def _uses(self, outputs: list[str]) -> Counter[str]:
        """How often each expression that the outputs need is written, by the text that stands for it."""
        uses, waiting = Counter(outputs), [*outputs]
        while waiting:
            text = waiting.pop()
            if not _NAME.fullmatch(text):
                continue
            form, inputs = self._expressions[int(text[1:])]
            for each in _PLACE.findall(form.replace("{}", "{0}", 1).replace("{}", "{1}", 1).replace("{}", "{2}", 1)):
                used = inputs[int(each)]
                if used not in uses:
                    waiting.append(used)
                uses[used] += 1
        return uses
