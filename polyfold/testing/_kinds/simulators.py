"""What simulators are held to; those that are a real table are not tried (:meth:`Subject.lacking`)."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np

from polyfold import plugins
from polyfold.errors import ActionError
from polyfold.testing._checks import checks
from polyfold.testing._materials import changed, kept
from polyfold.testing._subjects import Subject
from polyfold.types import Action

COARSE, SIZE = 0.03, 0.3


@contextmanager
def _laid(subject: Subject) -> Iterator[Any]:
    """A simulator with a small square on its table."""
    simulator = subject.make()
    try:
        simulator.reset(plugins.generate_garment("square", 0, COARSE, size=SIZE), 0)
        yield simulator
    finally:
        simulator.close()


def _diagonal(simulator: Any) -> Action:
    corners = simulator.state().keypoint_pixels()
    return Action(np.array([corners["bottom_left"]]), np.array([corners["top_right"]]))


@checks("simulators", "its pictures are pictures")
def _pictures(subject: Subject) -> None:
    with _laid(subject) as simulator:
        seen = simulator.observe()
    shape = (seen.camera.height, seen.camera.width)
    subject.require(
        seen.rgb.shape == (*shape, 3) and seen.rgb.dtype == np.uint8, "observe",
        f"rgb is {seen.rgb.dtype}, shape {seen.rgb.shape}", f"uint8, shape {(*shape, 3)} is the camera's",
    )  # fmt: skip
    subject.require(
        seen.depth.shape == shape and seen.depth.dtype == np.float32, "observe",
        f"depth is {seen.depth.dtype}, shape {seen.depth.shape}", f"float32, shape {shape}, metres from the camera",
    )  # fmt: skip


@checks("simulators", "the same seed and folds end in the same state, which is finite")
def _deterministic(subject: Subject) -> None:
    ends = []
    for _ in range(2):
        with _laid(subject) as simulator:
            simulator.execute(_diagonal(simulator))
            ends.append(simulator.state().positions)
    subject.require(np.isfinite(ends[0]).all(), "execute", "a particle is not finite", "raise SimulationError instead")
    subject.require(
        np.array_equal(*ends), "execute", f"two runs differ by {1000 * np.abs(ends[0] - ends[1]).max():.2g} mm",
        "seed all that is random from reset's seed, and keep the order of sums",
    )  # fmt: skip
    subject.require(
        ends[0][:, 2].max() > ends[0][:, 2].min(), "execute", "a fold changes nothing", "move what lies at the picks"
    )


@checks("simulators", "a state can be returned to, and folded on from, to the same end")
def _restores(subject: Subject) -> None:
    with _laid(subject) as simulator:
        action, start = _diagonal(simulator), simulator.state()
        simulator.execute(action)
        first = simulator.state().positions
        simulator.restore(start)
        back = np.abs(simulator.state().positions - start.positions).max()
        subject.require(back == 0.0, "restore", f"particles are {1000 * back:.2g} mm off", "put all of the state back")
        simulator.execute(action)
        off = float(np.abs(simulator.state().positions - first).max())
    subject.require(
        off == 0.0, "restore", f"the same fold from a restored state ends {1000 * off:.2g} mm off",
        "what the solver remembers besides positions belongs into state().extra",
    )  # fmt: skip


@checks("simulators", "pixels outside the picture are refused, and nothing is lost")
def _outside(subject: Subject) -> None:
    with _laid(subject) as simulator:
        before = simulator.state().positions.copy()
        try:
            simulator.execute(Action(np.array([(-50.0, 10.0)]), np.array([(100.0, 100.0)])))
        except ActionError:
            off = float(np.abs(simulator.state().positions - before).max())
            subject.require(off == 0.0, "execute", "a refused action moved the cloth", "check before anything moves")
            return
    subject.require(False, "execute", "a pick outside the picture is carried out", "call action.check_inside(camera)")


@checks("simulators", "a pick off the cloth moves nothing")
def _misses(subject: Subject) -> None:
    with _laid(subject) as simulator:
        before = simulator.state().positions.copy()
        simulator.execute(Action(np.array([(3.0, 3.0)]), np.array([(30.0, 30.0)])))
        off = float(np.abs(simulator.state().positions - before).max())
    subject.require(
        off < 0.005, "execute", f"a grip of bare table moved cloth by {1000 * off:.0f} mm", "it takes nothing"
    )


@checks("simulators", "it changes nothing that it is handed")
def _untouched(subject: Subject) -> None:
    simulator = subject.make()
    garment = plugins.generate_garment("square", 0, COARSE, size=SIZE)
    before = kept(garment.mesh)
    simulator.reset(garment, 0)
    action = _diagonal(simulator)
    asked = kept(action)
    simulator.execute(action)
    simulator.close()
    part = changed(before, garment.mesh)
    subject.require(not part, "reset", f"it writes into garment.mesh.{part}", "copy it: garments are used again")
    part = changed(asked, action)
    subject.require(not part, "execute", f"it writes into action.{part}", "copy it first")
