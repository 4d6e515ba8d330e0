"""Classes of components: what they may have of their own, beside what the runtime does in C."""

from __future__ import annotations

from seatrial.kits import is_ours
from seatrial.model.component import Component

from .domain import TranslationError

ROOTS = ("start", "step", "outputs")
"""Methods that the runtime calls: ``model_NAME`` in C."""
_ORDINARY = frozenset(
    {"__module__", "__doc__", "__annotations__", "__dict__", "__weakref__", "__orig_bases__"}
    | {"__parameters__", "__abstractmethods__", "__static_attributes__", "__firstlineno__"}
    | {"__annotate__", "__annotate_func__", "__annotations_cache__"}
)
_WRITTEN = (
    *(
        "feedthrough",
        "rolls_back",
        "discrete",
        "fixed_step",
        "terminals",
        "views",
        "structural",
        "tabulated",
    ),
    *("exercised", "ports", "scalars", "scalar_by_name", "_declared", "_settable"),
    *("_always_settable", "_of_type", "_real_outputs", "_of_real_outputs", "_other_outputs"),
    "_inputs",
)
"""What a class of a user may have of its own beside `ROOTS`, and what each class has."""
FRAMEWORK = frozenset(vars(Component())) | {
    name for name in dir(Component) if callable(getattr(Component, name))
}
"""Names that are not the component's to assign."""


def refuse_unusual(cls: type[Component]) -> None:
    """Raise TranslationError for a class that does by itself what the runtime does in C."""
    for base in cls.__mro__[:-1]:
        for name in () if is_ours(base.__module__) else vars(base):
            own = name.startswith("__") or hasattr(Component, name)
            if own and name not in (*_ORDINARY, *_WRITTEN, *ROOTS):
                raise TranslationError(f"{base.__name__}.{name}, a way of its own, has no C")
    if type(cls) is not type(Component):
        raise TranslationError(f"{cls.__name__}, made its own way, has no C")
