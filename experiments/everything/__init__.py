"""Make every recorded result again: ``make results``, or ``python -m experiments.everything``."""
