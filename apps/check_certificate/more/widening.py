"""How a function of the core is replaced."""


def widens(owner, name):
    """The decorated function takes the place of a module's function or a class's method, and gets that one first."""
    def place(wide):
        narrow = getattr(owner, name)
        setattr(owner, name, lambda *args, **named: wide(narrow, *args, **named))
        return wide

    return place
