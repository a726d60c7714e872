"""Cloth on a real table: any depth camera and any two arms behind the interfaces of :mod:`polyfold.plugins.hardware`.

:mod:`~polyfold_pybullet.real.overhead` makes of a camera at an angle the picture from above that the method works on;
:mod:`~polyfold_pybullet.real.asking` has a person agree before anything moves.
"""
