"""What interaction is made of: which garments, how they come to lie, what is tried on them, and what folds."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field, model_validator

from polyfold import plugins
from polyfold.config import ComponentSpec, Experiment
from polyfold.errors import ConfigError
from polyfold.plugins.interfaces import Segmenter, Simulator
from polyfold_fgpnp.data.trials import MIX
from polyfold_fgpnp.policies.weights import file_hash, weights_file

Course = Literal["good-folds", "random"]

FOLDS_IN_A_ROW = 4
"""Random folds, one upon the other, before a garment is laid out flat again: as the longest task has."""


def usual_mix(course: Course | None) -> dict[str, int]:
    """Trials of each recipe from a state of a course."""
    return {"uniform": 1} if course == "random" else dict(MIX)


class Interaction(BaseModel):
    """Parameters of interaction; the same ones and the same job give the same data.

    Weights count by their content: ``weights_hash`` follows from ``weights``, whose path is no parameter.

    ``course`` says how states come about. ``good-folds``: fold lines of four kinds, many picks tried from each state,
    and folded states from good folds along lines as a person would choose them. ``random``: the paper's (Sec. IV-D 3):
    a line between two random points of the contour, one pick, partners where affordance is best, unmoved, and what came
    of it is the next state, until the garment is laid out flat again after :data:`FOLDS_IN_A_ROW` folds.

    Raises:
        ConfigError: if the mix holds the recipe ``chosen`` without weights, weights without it, there is no file, or
            the random course is to try more than one pick from a state.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    garment_kind: str = Field(default="tshirt", description="kind of the garments")
    seeds: tuple[int, int] = Field(default=(1000, 1099), description="first and last garment seed")
    edge_length: float = Field(default=0.018, gt=0.005, le=0.05, description="edge length of the mesh [m]")
    course: Course = Field(default="good-folds", description="how states come about")
    mix: Mapping[str, int] = Field(
        default_factory=lambda given: usual_mix(given.get("course")),
        description="trials of each recipe from a state; by default what suits the course",
    )
    simulator: ComponentSpec = Field(default=ComponentSpec(name="xpbd"), description="what folds, with its parameters")
    fabric: ComponentSpec = Field(default=Experiment().fabric, description="what the garments are made of")
    segmenter: ComponentSpec = Field(default=ComponentSpec(name="colour"), description="what tells cloth from table")
    seed: int = Field(default=0, ge=0, description="of everything random")
    weights: Path | None = Field(default=None, exclude=True, description="file of the network that chosen picks ask")
    weights_hash: str | None = Field(default=None, description="SHA-256 of that file")

    @model_validator(mode="before")
    @classmethod
    def _with_hash(cls, given: Any) -> Any:
        """Hash the file; a description of data that was collected holds the hash alone."""
        if not isinstance(given, Mapping) or given.get("weights") is None:
            return given
        file = weights_file(str(given["weights"]))
        return {**given, "weights": file, "weights_hash": file_hash(file)}

    @model_validator(mode="after")
    def _weights_go_with_chosen(self) -> Interaction:
        if "chosen" in self.mix and self.weights_hash is None:
            raise ConfigError("the recipe chosen asks a trained network where to pick; give its file with --weights")
        if "chosen" not in self.mix and self.weights_hash is not None:
            raise ConfigError("no recipe of the mix asks the weights; add chosen, such as --mix chosen=3,uniform=1")
        return self

    @model_validator(mode="after")
    def _one_pick_on_a_random_course(self) -> Interaction:
        if self.course == "random" and sum(self.mix.values()) != 1:
            raise ConfigError(
                "on the course random what came of a pick is the next state, so one is tried from each: give a mix of "
                "one, such as --mix uniform=1, or the course good-folds"
            )
        return self


def create_simulator(interaction: Interaction) -> Simulator:
    """What folds. Raises PluginError or ConfigError."""
    return plugins.create("simulators", interaction.simulator.name, interaction.simulator.params)


def create_segmenter(interaction: Interaction) -> Segmenter:
    """What tells cloth from table. Raises PluginError or ConfigError."""
    return plugins.create("segmenters", interaction.segmenter.name, interaction.segmenter.params)
