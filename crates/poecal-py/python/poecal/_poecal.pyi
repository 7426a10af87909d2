def version() -> str:
    """The version of poecal that this module was built from."""
