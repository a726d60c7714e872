"""Frames: what each clause of a sentence says, in the order in which it is done."""
