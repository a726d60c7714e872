"""Overlays, filmstrips, animations and sheets, as uint8 arrays of shape (H, W, 3) and as files.

Images in, images out; nothing here needs an episode, a simulator or a display. Colours can be told apart by
colour-blind readers and every stroke has a light edge, so that it shows on any cloth.
"""
