"""MuJoCo's flexes as cloth, with the settings of the cloth among its examples."""

from __future__ import annotations

import numpy as np

from experiments.benchmarks.cloth.engines.job import Floats, Job

STEP, RADIUS = 0.002, 0.004
"""Time step [s] and half the thickness of the sheet [m] of the example."""
WEIGHT = 0.25 / (12 * 0.055) ** 2
"""Mass of an area of the example's cloths [kg/m²]."""
ELASTICITY = 'young="4348" poisson="0.4" thickness="0.0013416" elastic2d="both" damping="0.01"'
"""The example's 2e4, 0.2 and 0.001 converted as MuJoCo 4.0's change log has it, so that the cloth stays the same."""


def drape(job: Job) -> tuple[Floats, float]:
    """Elastic flex as in MuJoCo's ``model/flex/drape.xml`` (August 2026), in which three cloths fall on a ball.

    Three things differ from the example. Its contacts are passive, which means without friction: so the cloth slides
    off the table, and ours are the usual ones, as MuJoCo's guide advises where friction matters. Its solver is CG with
    ``implicitfast``; MuJoCo 4.0 takes elastic flexes with ``discrete`` only and advises Newton's method for cloth. And
    the grippers: bodies without dynamics, each tied to a vertex by a constraint as stiff as the guide recommends.
    """
    import mujoco  # pyright: ignore[reportMissingImports]  (few have it)

    job = job.stacked(ground=RADIUS, gap=2 * RADIUS)
    model = mujoco.MjModel.from_xml_string(_scene(job))
    data = mujoco.MjData(model)
    # The plies lie in one plane at rest, so that the layers' distance isn't taken for the length of cloth at the seams.
    data.qpos.reshape(-1, 3)[:, 2] = job.flat[:, 2] - RADIUS
    data.mocap_pos[:] = job.flat[job.held]
    mujoco.mj_forward(model, data)

    def hold(positions: Floats) -> None:
        data.mocap_pos[:] = positions

    def release() -> None:
        data.eq_active[:] = 0

    mujoco.set_mju_user_warning(print)  # else they go to a file in the current folder
    seconds = job.play(STEP, hold, lambda: mujoco.mj_step(model, data), release)
    bad = mujoco.mjtWarning.mjWARN_BADQPOS, mujoco.mjtWarning.mjWARN_BADQVEL, mujoco.mjtWarning.mjWARN_BADQACC
    # MuJoCo starts anew where a state is not finite any more, which would pass for cloth that was never folded.
    exploded = any(data.warning[kind].number for kind in bad)
    return np.full_like(data.flexvert_xpos, np.nan) if exploded else data.flexvert_xpos.copy(), seconds


def _scene(job: Job) -> str:
    """MJCF of the cloth in one plane on a table, each held vertex tied to a gripper."""
    triangles = np.asarray(job.garment.mesh.triangles)
    flat = job.garment.mesh.vertices[triangles]
    u, v = flat[:, 1] - flat[:, 0], flat[:, 2] - flat[:, 0]
    mass = WEIGHT * np.abs(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]).sum() / 2
    grips = "\n".join(
        f'<body name="grip_{k}" mocap="true" pos="{x:.6f} {y:.6f} {RADIUS}"/>'
        for k, (x, y) in enumerate(job.flat[job.held, :2])
    )
    ties = "\n".join(
        f'<connect body1="cloth_{particle}" body2="grip_{k}" anchor="0 0 0" solref="0.004 1"/>'
        for k, particle in enumerate(job.held)
    )
    points = " ".join(f"{x:.6f} {y:.6f} {RADIUS}" for x, y in job.flat[:, :2])
    return f"""
<mujoco>
  <option timestep="{STEP}" integrator="discrete" solver="Newton" tolerance="1e-6" iterations="400"/>
  <size memory="2G"/>
  <worldbody>
    <geom type="plane" size="0 0 1"/>
    {grips}
    <flexcomp name="cloth" type="direct" dim="2" radius="{RADIUS}" mass="{mass:.6f}"
              point="{points}" element="{" ".join(map(str, triangles.ravel()))}">
      <contact selfcollide="auto" solref="0.01 1" solimp=".95 .99 .0001"/>
      <elasticity {ELASTICITY}/>
    </flexcomp>
  </worldbody>
  <equality>
    {ties}
  </equality>
</mujoco>
"""
