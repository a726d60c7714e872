from hypothesis import settings

# The first call of a compiled or lazily imported function is slow; a deadline would judge that, not the property.
settings.register_profile("project", deadline=None, derandomize=True)
settings.load_profile("project")
