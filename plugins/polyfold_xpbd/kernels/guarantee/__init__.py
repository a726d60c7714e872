"""The guarantee that no ply passes through another: what could meet, and what keeps it apart."""
