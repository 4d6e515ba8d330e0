"""Keys of a profile: tables of its schema."""

from __future__ import annotations

import datetime
import json
import re
from functools import partial

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from parts import part
from parts.markdown import table
from seatrial.system.profile.file import Actuator, Home, Identity, ProfileFile

MODELS: dict[str, tuple[type[BaseModel], str]] = {
    "profile": (ProfileFile, "key"),
    "identity": (Identity, "key of `identity`"),
    "home": (Home, "key of `home`"),
    "actuator": (Actuator, "key of an actuator"),
}


def _default(field: FieldInfo) -> str:
    value = field.get_default(call_default_factory=True, validated_data={})
    if value is PydanticUndefined:
        return "needed"
    if value is None:
        return "none"
    if isinstance(value, BaseModel):
        return "its keys' defaults"
    if isinstance(value, datetime.date):
        return f"`{value}`"
    return f"`{json.dumps(value)}`" if value not in ("", {}, []) else "empty"


def _shown(text: str | None) -> str:
    """Return a text with the page's minus signs."""
    assert text
    return re.sub(r"(?<![\w-])-(?=\d)|(?<= )-(?= )", "−", text)


def keys(name: str) -> str:
    """Return the marker that a model's table has, and its table."""
    model, head = MODELS[name]
    rows = [
        (f"`{key}`", _shown(field.title), _default(field), _shown(field.description))
        for key, field in model.model_fields.items()
    ]
    marker = f"<!-- keys of {model.__module__}.{model.__name__} -->\n\n"
    return marker + table((head, "type", "default", "meaning"), rows)


for _name in MODELS:
    part(f"{_name}-keys")(partial(keys, _name))
