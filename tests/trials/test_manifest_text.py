"""The text of a manifest that ends is put together of what is encoded once."""

from __future__ import annotations

import json
from typing import Any

import pytest

from seatrial.trial.running.output import json_text, with_more


@pytest.mark.parametrize("decided", [{"a": 1}, {"a": {"b": [1, {}]}, "ü": "\n}"}])
@pytest.mark.parametrize("more", [{"status": "failed", "error": "{ }"}, {"error": None}])
def test_more_behind_an_object_is_text_of_the_whole(
    decided: dict[str, Any], more: dict[str, Any]
) -> None:
    expected = json.dumps({**decided, **more}, indent=1, ensure_ascii=False)
    assert with_more(json_text(decided), more) == expected
