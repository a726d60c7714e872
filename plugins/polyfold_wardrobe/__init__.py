"""Garments beyond the paper's four: skirts, shorts, tank tops, long-sleeved shirts and towels of any proportion.

They are made of public names alone, as a package of anybody's would be; ``polyfold new-plugin --kind garment`` writes
the beginning of one. Each module holds one kind whole: how it is cut (``generate``), what it may look like
(``template``) and what its parts are called, from which language is understood.

A template whose vertices are named as those of a t-shirt (``sleeve_…``), trousers (``crotch``) or a towel
(``bottom_left`` …) is folded as these are. Of others, names that end in ``_left`` and ``_right`` tell the sides;
``hem``, ``waist`` and ``strap_outer`` tell bottom and top.
"""
