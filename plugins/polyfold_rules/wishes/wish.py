"""What the end of an instruction that leaves the folds open should be."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Bound:
    """A ratio to the flat garment that the end must keep; ``aim`` is the value wished for, if it is one."""

    quantity: str
    low: float = 0.0
    high: float = 9.0
    aim: float | None = None


@dataclass
class Wish:
    """What the end should be; what is None or empty was not said.

    Attributes:
        bounds: ratios that it must keep.
        looks: what it should resemble, by the names of ``wishes.txt``.
        shapes: ``triangle``, ``square``, ``rectangle``, ``strip``.
        purposes: what it is for.
        hidden: sleeves that must not stick out, or corners that must be folded in.
        kept: edges that must stay where they are.
        lies: sides of the flat garment's place that it should lie on.
        points: the side to which it should point.
        steps: (least, most) number of folds.
        small: it should be small.
        tidy: it should be neat, which is small if nothing else is said.
        least: it should be as small as can be.
        words: what the wish was read from, as said.
        passed: unknown words in adjuncts, which tell nothing about the end.
    """

    bounds: list[Bound] = field(default_factory=list)
    looks: list[str] = field(default_factory=list)
    shapes: list[str] = field(default_factory=list)
    purposes: list[str] = field(default_factory=list)
    hidden: set[str] = field(default_factory=set)
    kept: set[str] = field(default_factory=set)
    lies: set[str] = field(default_factory=set)
    points: str = ""
    steps: tuple[int, int] | None = None
    small: bool = False
    tidy: bool = False
    least: bool = False
    words: list[str] = field(default_factory=list)
    passed: list[str] = field(default_factory=list)

    @property
    def says_something(self) -> bool:
        """Whether it wants anything of the end; a number of folds alone does not."""
        return bool(
            self.bounds or self.looks or self.shapes or self.purposes or self.hidden or self.lies or self.points
            or self.small or self.tidy or self.least
        )  # fmt: skip

    @property
    def merely_tidy(self) -> bool:
        """Whether it wants the cloth neat and nothing else."""
        return (
            self.tidy
            and self.steps is None
            and not (self.bounds or self.looks or self.shapes or self.purposes or self.hidden or self.lies)
        )

    @property
    def sized(self) -> bool:
        """Whether it says how large the end should be."""
        return bool(self.bounds)
