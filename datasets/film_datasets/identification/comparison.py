"""compare_laws: the same measurement fitted with several contact laws."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from film_datasets.identification.least_squares import identify
from film_datasets.identification.result import Identification
from film_model.base.errors import SceneError, SimulationError, not_compared
from film_model.base.foreign import Dataset
from film_model.scene import Scene


@dataclass(frozen=True)
class LawFit:
    """One law. fit: None if it cannot be fitted, for the reason in `reason`. residual: root mean square over the
    largest value of each quantity. criterion: Akaike's information criterion, corrected for few points; the least is
    best. needs: the entries of [contact] that the law needs, if that is the reason."""

    law: str
    fit: Identification | None
    residual: float = math.inf
    criterion: float = math.inf
    reason: str = ""
    needs: tuple[str, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Plain values; None for what is not known."""
        numbers = {"residual": self.residual, "criterion": self.criterion}
        plain = {name: value if math.isfinite(value) else None for name, value in numbers.items()}
        fit = None if self.fit is None else self.fit.to_dict()
        return {"law": self.law, **plain, "reason": self.reason, "needs": list(self.needs), "fit": fit}


def compare_laws(
    measured: Dataset | Sequence[Dataset],
    scene: Scene,
    fit: Sequence[str],
    laws: Sequence[str],
    confidence: float = 0.99,
    **options: Any,
) -> list[LawFit]:
    """Fit the parameters `fit` with each of the laws (see `identify`, also for the options); the best law first, those
    that cannot last.

    A law's own parameters that are not fitted are those of the scene. AICc = n ln(S/n) + 2 k + 2 k (k + 1)/(n - k - 1)
    for n points, the sum of squares S and k parameters, the variance among them (Hurvich and Tsai 1989); differences
    below about 2 decide nothing. S is at least the rounding error of the model.
    """
    return sorted(
        (_fit(measured, scene, fit, law, {"confidence": confidence, **options}) for law in laws),
        key=lambda one: one.criterion,
    )


def _fit(
    measured: Dataset | Sequence[Dataset], scene: Scene, fit: Sequence[str], law: str, options: dict[str, Any]
) -> LawFit:
    try:
        found = identify(measured, scene.replace({"contact.law": law}), fit, **options)
    except (SceneError, SimulationError, ValueError) as error:
        needs = error.needed if isinstance(error, SceneError) else ()
        return LawFit(law, None, reason=" ".join(str(error).split("\n")), needs=tuple(needs))
    n, k = found.points, len(found.parameters) + 1
    residual = math.sqrt(found.square / n)
    correction = 2.0 * k * (k + 1) / (n - k - 1) if n > k + 1 else math.inf
    # below 1e-7, the accuracy of the impacts that are compared, two fits are equal
    criterion = 2.0 * n * math.log(max(residual, 1e-7)) + 2.0 * k + correction
    return LawFit(law, found, residual, criterion)


def comparison_table(found: Sequence[LawFit]) -> str:
    """The laws as text: residual, and how much worse the criterion is than that of the best."""
    lines = [f"  {'law':22}{'RMS residual':>14}{'AICc above best':>18}"]
    needing = {one.law: one.needs for one in found if one.needs}
    for one in found:
        if one.law in needing:
            continue
        if one.fit is None:
            lines.append(f"  {one.law:22}{'-':>14}{'-':>18}   {one.reason}")
            continue
        texts = [f"{p.path} {p.text(p.value) if p.identified else p.limit()}" for p in one.fit.parameters]
        above = one.criterion - found[0].criterion
        lines.append(f"  {one.law:22}{100 * one.residual:>12.3g} %{above:>18.1f}   {', '.join(texts)}")
    return "\n".join([*lines, *([not_compared(needing)] if needing else [])])
