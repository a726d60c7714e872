"""Newton's cloth solvers on the CPU, with the settings of the examples that newton comes with."""

from __future__ import annotations

from typing import Any

import numpy as np

from experiments.benchmarks.cloth.engines.job import Floats, Job

FRAME, SUBSTEPS = 1 / 60, 10
"""Time of a frame [s] and substeps in it, in both examples."""


def vbd(job: Job) -> tuple[Floats, float]:
    """``SolverVBD`` as in newton's ``example_cloth_franka.py``, in which a robot folds a t-shirt.

    The example computes in centimetres and grams, and so do we. All values are its own: weight, stiffness, damping,
    radii, margins, frictions, buffers, substeps, iterations. Its table is our ground, its robot our grippers.
    """
    newton, wp = _newton()
    # Sheets that lie less than 5 mm apart at the start never touch: such pairs are left out, as at rest they are near.
    job = job.stacked(ground=0.008, gap=0.006)
    with wp.ScopedDevice("cpu"):
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, -981.0))
        builder.add_cloth_mesh(
            pos=wp.vec3(0.0), rot=wp.quat_identity(), scale=1.0, vel=wp.vec3(0.0),
            vertices=[wp.vec3(100 * x, 100 * y, 0.0) for x, y in job.garment.mesh.vertices],
            indices=job.garment.mesh.triangles.ravel().tolist(),
            density=0.02, tri_ke=1e4, tri_ka=1e4, tri_kd=1.5e-2, edge_ke=5.0, edge_kd=5e-1, particle_radius=0.8,
        )  # fmt: skip
        builder.color()
        builder.add_ground_plane()
        model = builder.finalize()
        model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = 1e4, 1e1, 0.25
        for array, value in (
            (model.shape_material_ke, 5e4), (model.shape_material_kd, 5e1), (model.shape_material_mu, 1.5),
        ):  # fmt: skip
            array.fill_(value)
        model.edge_rest_angle.zero_()
        model.particle_q.assign((100 * job.flat).astype(np.float32))
        pipeline = newton.CollisionPipeline(model, soft_contact_gap=0.8)
        slots, times = newton.solvers.SolverBase.CollisionSlot, newton.solvers.SolverBase.CollisionFrequencyType
        solver = newton.solvers.SolverVBD(
            model, iterations=5, integrate_with_external_rigid_solver=True, particle_enable_self_contact=True,
            particle_self_contact_margin=0.2, particle_self_contact_gap=0.0,
            particle_topological_contact_filter_threshold=1, particle_rest_shape_contact_exclusion_radius=0.5,
            particle_vertex_contact_buffer_size=16, particle_edge_contact_buffer_size=20,
            collision_frequency_type={slots.SOFT_SELF_CONTACT: times.PRE_INIT},
        )  # fmt: skip
        return _play(job, model, solver, pipeline, scale=100, collide_each_substep=True, rebuild=True, record=True)


def style3d(job: Job) -> tuple[Floats, float]:
    """``SolverStyle3D`` as in newton's ``example_cloth_style3d.py``, which drapes a sweatshirt on a mannequin.

    All values are its own. The distance that its sheets keep, 6 mm, is the solver's and can't be set.
    """
    newton, wp = _newton()
    from newton.solvers import style3d as helpers  # pyright: ignore[reportMissingImports]  (as above)

    job = job.stacked(ground=0.005, gap=0.006)
    panels, indices = _panels(job)
    with wp.ScopedDevice("cpu"):
        builder = newton.ModelBuilder(up_axis=newton.Axis.Z)
        newton.solvers.SolverStyle3D.register_custom_attributes(builder)
        helpers.add_cloth_mesh(
            builder, pos=wp.vec3(0.0), rot=wp.quat_identity(), vel=wp.vec3(0.0), scale=1.0,
            vertices=job.flat.tolist(), indices=job.garment.mesh.triangles.ravel().tolist(),
            panel_verts=panels.tolist(), panel_indices=indices.ravel().tolist(),
            density=0.3, particle_radius=5e-3,
            tri_aniso_ke=wp.vec3(1e2, 1e2, 1e1), edge_aniso_ke=wp.vec3(2e-5, 1e-5, 5e-6),
        )  # fmt: skip
        builder.add_ground_plane()
        model = builder.finalize()
        model.soft_contact_ke, model.soft_contact_kd, model.soft_contact_mu = 1e1, 1e-5, 0.2
        model.set_gravity((0.0, 0.0, -9.81))
        config = newton.solvers.SolverStyle3D.Config(iterations=4)
        solver = newton.solvers.SolverStyle3D(model=model, config=config)
        pipeline = newton.CollisionPipeline(model)
        return _play(job, model, solver, pipeline, scale=1, collide_each_substep=False, rebuild=False, record=False)


def _newton() -> tuple[Any, Any]:
    import warp as wp  # pyright: ignore[reportMissingImports]  (comes with newton, which few have)

    wp.config.quiet = True  # before newton, which starts warp
    import newton  # pyright: ignore[reportMissingImports]  (as above)

    return newton, wp


def _panels(job: Job) -> tuple[Floats, Any]:
    """Flat corners [m], shape (M, 2), and triangles, shape (T, 3), that all turn left: a back seen from its outside."""
    flat, triangles = np.asarray(job.garment.mesh.vertices, float), np.asarray(job.garment.mesh.triangles)
    a, b, c = flat[triangles[:, 0]], flat[triangles[:, 1]], flat[triangles[:, 2]]
    u, v = b - a, c - a
    right = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0] < 0
    return np.concatenate([flat, flat * [-1, 1]]), np.where(right[:, None], triangles + len(flat), triangles)


def _play(
    job: Job,
    model: Any,
    solver: Any,
    pipeline: Any,
    *,
    scale: float,
    collide_each_substep: bool,
    rebuild: bool,
    record: bool,
) -> tuple[Floats, float]:
    """Fold with grippers that hold particles as newton's ``example_cloth_twist.py`` does: taken out of the solving."""
    newton, wp = _newton()
    states = [model.state(), model.state()]
    control, contacts = model.control(), pipeline.contacts()

    def substep(number: int) -> None:
        now, then = states if number % 2 == 0 else states[::-1]
        if number % SUBSTEPS == 0 and rebuild:
            solver.rebuild_bvh(now)
        if number % SUBSTEPS == 0 or collide_each_substep:
            pipeline.collide(now, contacts)
        now.clear_forces()
        then.clear_forces()
        solver.step(now, then, control, contacts, FRAME / SUBSTEPS)

    def put(positions: Floats, particles: Any) -> None:
        for state in states:
            state.particle_q.numpy()[particles] = scale * positions
            state.particle_qd.numpy()[particles] = 0.0

    for number in range(2):  # what compiles compiles now
        substep(number)
    # Recorded as in the example, which saves the time that Python takes.
    graphs = []
    for number in range(SUBSTEPS) if record else ():
        with wp.ScopedCapture() as capture:
            substep(number)
        graphs.append(capture.graph)
    put(job.flat, slice(None))
    flags = model.particle_flags.numpy()
    free = flags.copy()
    flags[job.held] &= ~int(newton.ParticleFlags.ACTIVE)

    done = 0

    def advance() -> None:
        nonlocal done
        if record:
            wp.capture_launch(graphs[done % SUBSTEPS])
        else:
            substep(done)
        done += 1

    def release() -> None:
        flags[:] = free

    seconds = job.play(FRAME / SUBSTEPS, lambda positions: put(positions, job.held), advance, release)
    return states[done % 2].particle_q.numpy().astype(float) / scale, seconds
