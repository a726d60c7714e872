"""The same half fold in our simulator and in other engines: ``python -m experiments.benchmarks.cloth.engines``.

Needs PyBullet and ``pip install newton``; an engine that isn't installed is skipped. Times are processor seconds per
fold, loading and compiling left out. The other engines get plain settings, not tuned ones: one that explodes or
gives up here may do better with others. The grippers hold all layers within 15 mm of the picks and turn them along
half an ellipse.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import multiprocessing
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiments.benchmarks.cloth.folding import Fold, Script, Trial, mask_of
from polyfold import plugins
from polyfold.garments import Garment
from polyfold.geometry import iou
from polyfold.types import Action, SimState

Floats = NDArray[np.float64]

HALVES = (
    Script(
        "half fold of a square",
        "square",
        (Fold(("bottom_left+bottom_right>top_left+top_right",), ("bottom_left", "bottom_right")),),
    ),
    Script(
        "half fold of a t-shirt",
        "tshirt",
        (Fold(("hem_left+hem_right>shoulder_left+shoulder_right",), ("hem_left", "hem_right")),),
    ),
)
REACH, HEIGHT, DURATION, SETTLING = 0.015, 0.45, 1.2, 0.6
"""Radius of a grasp [m], height of the path as a share of its width, time of the motion and for settling [s]."""

PATIENCE = 120.0
"""An engine that needs longer than this for one fold is stopped [s]."""


@dataclass(frozen=True, eq=False)
class Job:
    """A fold to do.

    Attributes:
        garment: what is folded.
        flat: particle positions at the start [m], shape (N, 3).
        held: indices of the held particles, shape (G,).
        arms: which arm holds each, shape (G,).
        starts, ends: pick and place points [m], shape (arms, 3).
    """

    garment: Garment
    flat: Floats
    held: NDArray[np.int64]
    arms: NDArray[np.int64]
    starts: Floats
    ends: Floats

    def carried(self, progress: float) -> Floats:
        """Where the held particles belong [m], shape (G, 3), at ``progress`` from 0 to 1."""
        angle = np.pi * progress * progress * (3 - 2 * progress)
        c, s = np.cos(angle), np.sin(angle)
        span = self.ends - self.starts
        width = np.linalg.norm(span, axis=1, keepdims=True)
        forward = (span / width)[self.arms]
        centre = (self.starts + (1 - c) / 2 * span + np.array([0, 0, s * HEIGHT]) * width)[self.arms]
        offset = self.flat[self.held] - self.starts[self.arms]
        along, up = (offset * forward).sum(1), offset[:, 2]
        turned = offset + (c * along + s * up - along)[:, None] * forward
        turned[:, 2] = c * up - s * along
        return centre + turned


def main(arguments: Sequence[str] | None = None) -> None:
    """Run every engine that is installed on both garments."""
    parser = argparse.ArgumentParser(prog="python -m experiments.benchmarks.cloth.engines", description=__doc__)
    parser.add_argument("--seed", type=int, default=2000, help="garment seed (default 2000)")
    parser.add_argument("--edge-length", type=float, default=0.0155, help="edge length of the mesh [m]")
    options = parser.parse_args(arguments)
    print(
        "| fold | engine | particles | CPU s | times ours | IoU | error of moved particles |\n"
        "|---|---|---|---|---|---|---|"
    )
    for script in HALVES:
        garment = plugins.generate_garment(script.kind, options.seed, options.edge_length)
        _compare(script, garment, options.seed)


def _compare(script: Script, garment: Garment, seed: int) -> None:
    simulator = plugins.create("simulators", "xpbd")
    simulator.reset(garment, seed)
    flat = simulator.state()
    trial = Trial(script, flat)
    action = trial.act(script.folds[0], flat)
    simulator.execute(action)
    simulator.restore(flat)
    started = time.process_time()
    simulator.execute(action)
    ours = time.process_time() - started
    _report(script, "polyfold xpbd", trial, garment, simulator.state(), ours, ours)
    job = _job(garment, flat, action)
    engines: dict[str, tuple[str, Callable[[Job], tuple[Floats, float]]]] = {
        "newton SolverXPBD": ("newton", _newton),
        "PyBullet soft body": ("pybullet", _pybullet),
    }
    for name, (package, fold) in engines.items():
        if importlib.util.find_spec(package) is None:
            print(f"| {script.name} | {name} | skipped: not installed, pip install {package} | | | | |")
            continue
        try:
            positions, seconds = _in_child(fold, job)
        except TimeoutError:
            print(
                f"| {script.name} | {name} | {len(flat.positions)} | gave up after {PATIENCE:.0f} s | | | |", flush=True
            )
            continue
        state = SimState(positions, np.zeros_like(positions), flat.keypoints, flat.camera)
        _report(script, name, trial, garment, state, seconds, ours)


def _in_child(fold: Callable[[Job], tuple[Floats, float]], job: Job) -> tuple[Floats, float]:
    """Run an engine in a process of its own, which can be stopped even in the middle of one of its steps.

    Raises:
        TimeoutError: after ``PATIENCE``, or if the engine brought its process down.
    """
    context = multiprocessing.get_context("spawn")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_send, args=(sender, fold, job), daemon=True)
    child.start()
    sender.close()
    try:
        if not receiver.poll(PATIENCE):
            raise TimeoutError
        return receiver.recv()
    except EOFError as error:
        raise TimeoutError from error
    finally:
        child.kill()
        child.join()


def _send(sender: Any, fold: Callable[[Job], tuple[Floats, float]], job: Job) -> None:
    # Engines announce themselves; the table is what should be printed.
    with contextlib.redirect_stdout(sys.stderr):
        sender.send(fold(job))


def _report(
    script: Script, name: str, trial: Trial, garment: Garment, state: SimState, seconds: float, ours: float
) -> None:
    triangles, camera = garment.mesh.triangles, state.camera
    if np.isfinite(state.positions).all() and np.abs(state.positions).max() < 10:
        mask = mask_of(camera.to_pixels(state.positions), triangles, (camera.height, camera.width))
        overlap = f"{iou(mask, trial.ideal_mask(triangles)):.3f}"
        error = f"{1000 * trial.flap_error(state)[0]:.0f} mm"
    else:
        overlap, error = "exploded", "-"
    count = len(state.positions)
    print(
        f"| {script.name} | {name} | {count} | {seconds:.2f} | {seconds / ours:.0f} | {overlap} | {error} |", flush=True
    )


def _job(garment: Garment, flat: SimState, action: Action) -> Job:
    positions = flat.positions
    distances = np.array([np.hypot(*(positions - flat.camera.to_world(p))[:, :2].T) for p in action.picks])
    held = np.flatnonzero(distances.min(axis=0) <= REACH)
    top = positions[:, 2].max()
    return Job(
        garment,
        positions,
        held,
        distances[:, held].argmin(axis=0),
        flat.camera.to_world(action.picks, top / 2),
        flat.camera.to_world(action.places, 2 * top + 0.004),
    )


def _newton(job: Job) -> tuple[Floats, float]:
    """Newton's particle solver on the CPU, 20 substeps per 1/60 s."""
    import warp as wp  # pyright: ignore[reportMissingImports]  (comes with newton, which few have)

    wp.config.quiet = True  # before newton, which starts warp
    import newton  # pyright: ignore[reportMissingImports]  (as above)

    radius, substeps, frame = 0.005, 20, 1 / 60
    # Spheres of this size touch at twice the radius, so its two layers have to lie farther apart than ours.
    start = job.flat.copy()
    start[:, 2] = radius + 2 * radius * np.asarray(job.garment.mesh.layer)
    job = replace(job, flat=start)
    with wp.ScopedDevice("cpu"):
        builder = newton.ModelBuilder()
        builder.add_ground_plane()
        builder.add_cloth_mesh(
            pos=wp.vec3(0.0), rot=wp.quat_identity(), scale=1.0, vel=wp.vec3(0.0),
            vertices=[wp.vec3(*map(float, p)) for p in start],
            indices=job.garment.mesh.triangles.ravel().tolist(),
            density=job.garment.fabric.weight, tri_ke=0.0, tri_ka=0.0, tri_kd=0.0, edge_ke=1e-5, edge_kd=0.0,
            add_springs=True, spring_ke=1e4, spring_kd=0.0, particle_radius=radius,
        )  # fmt: skip
        model = builder.finalize()
        fabric = job.garment.fabric
        model.soft_contact_mu, model.particle_mu = fabric.table_friction, fabric.cloth_friction
        model.particle_max_velocity = 5.0
        # Its constraints are solved all at once, so that stiff springs need strong relaxation.
        solver = newton.solvers.SolverXPBD(model=model, iterations=4, soft_body_relaxation=0.2)
        states = [model.state(), model.state()]
        control, contacts = model.control(), model.contacts()

        def run(frames: int, progress: Callable[[float], float | None]) -> None:
            for step in range(frames * substeps):
                if step % substeps == 0:
                    model.collide(states[0], contacts)
                held_at = progress(step / (frames * substeps))
                if held_at is not None:
                    q, qd = states[0].particle_q.numpy(), states[0].particle_qd.numpy()
                    q[job.held], qd[job.held] = job.carried(held_at), 0.0
                states[0].clear_forces()
                solver.step(states[0], states[1], control, contacts, frame / substeps)
                states.reverse()

        run(1, lambda _: None)
        states[0].particle_q.assign(start.astype(np.float32))
        states[0].particle_qd.zero_()
        started = time.process_time()
        # What a gripper holds must not be moved by the constraints between the steps that place it.
        inverse_mass = model.particle_inv_mass.numpy()
        free = inverse_mass.copy()
        inverse_mass[job.held] = 0.0
        run(round(DURATION / frame), lambda t: t)
        inverse_mass[:] = free
        run(round(SETTLING / frame), lambda _: None)
        seconds = time.process_time() - started
        return states[0].particle_q.numpy().astype(float), seconds


def _pybullet(job: Job) -> tuple[Floats, float]:
    """Bullet's deformable mass-spring cloth, 240 steps a second, held by anchors to moving bodies."""
    import pybullet as bullet

    client = bullet.connect(bullet.DIRECT)
    try:
        bullet.resetSimulation(bullet.RESET_USE_DEFORMABLE_WORLD)
        bullet.setGravity(0, 0, -9.81)
        bullet.setTimeStep(1 / 240)
        plane = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=[2, 2, 0.1])
        bullet.createMultiBody(0, plane, basePosition=[0, 0, -0.1])
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "cloth.obj"
            path.write_text(_as_obj(job.flat, job.garment.mesh.triangles))
            cloth = bullet.loadSoftBody(
                str(path), mass=0.1, useMassSpring=1, useBendingSprings=1, useNeoHookean=0,
                springElasticStiffness=40, springDampingStiffness=0.1, springBendingStiffness=0.1,
                frictionCoeff=job.garment.fabric.table_friction,
                useSelfCollision=1, collisionMargin=0.003, useFaceContact=0,
            )  # fmt: skip
        vertices = _soft_vertices(bullet, cloth)
        # Bullet orders vertices by their first use in a triangle.
        nearest = np.linalg.norm(vertices[None] - job.flat[:, None], axis=2).argmin(axis=1)
        started = time.process_time()
        point = bullet.createCollisionShape(bullet.GEOM_SPHERE, radius=1e-4)
        bodies, anchors = [], []
        for k, vertex in enumerate(nearest[job.held]):
            body = bullet.createMultiBody(0, point, basePosition=job.carried(0.0)[k].tolist())
            bullet.setCollisionFilterGroupMask(body, -1, 0, 0)
            bodies.append(body)
            anchors.append(bullet.createSoftBodyAnchor(cloth, int(vertex), body, -1))
        for step in range(round(DURATION * 240)):
            for body, target in zip(bodies, job.carried(step / (DURATION * 240)), strict=True):
                bullet.resetBasePositionAndOrientation(body, target.tolist(), [0, 0, 0, 1])
            bullet.stepSimulation()
        for anchor in anchors:
            bullet.removeConstraint(anchor)
        for _ in range(round(SETTLING * 240)):
            bullet.stepSimulation()
        seconds = time.process_time() - started
        return _soft_vertices(bullet, cloth)[nearest], seconds
    finally:
        bullet.disconnect(client)


def _soft_vertices(bullet: Any, body: int) -> Floats:
    count, data = bullet.getMeshData(body, -1, flags=bullet.MESH_DATA_SIMULATION_MESH)
    return np.array(data[:count], float)


def _as_obj(vertices: Floats, triangles: NDArray[np.int32]) -> str:
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in vertices]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in triangles]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    main()
