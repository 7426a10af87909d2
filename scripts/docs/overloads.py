"""Methods of which the stubs have overloads alone, on the page of the Python package: griffe leaves them out."""

import griffe


class Overloads(griffe.Extension):
    """Shows the last overload, the most general one, with the docstring of the first."""

    def on_class_members(self, *, cls, **kwargs):
        for name, functions in cls.overloads.items():
            if name not in cls.members:
                shown = functions[-1]
                shown.docstring = functions[0].docstring
                cls.set_member(name, shown)
