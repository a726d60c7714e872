"""What each kind of component is held to."""
