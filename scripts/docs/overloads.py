"""Functions with overloads only in the stubs, on the page of the Python package: griffe leaves them out."""

import griffe


class Overloads(griffe.Extension):
    """Shows the last overload, the most general one, with the docstring of the first."""

    def on_class_members(self, *, cls, **kwargs):
        show(cls)

    def on_module_members(self, *, mod, **kwargs):
        show(mod)


def show(owner):
    for name, functions in owner.overloads.items():
        if name not in owner.members:
            shown = functions[-1]
            shown.docstring = functions[0].docstring
            owner.set_member(name, shown)
