"""Cameras and arms that are not simulated, each behind the interfaces of :mod:`polyfold.plugins.hardware`.

Arms plan in the same cell as the simulated ones (:class:`~polyfold_pybullet.drivers.driven.DrivenArms`) and hand each
motion to a link, which is what differs between makes.
"""
