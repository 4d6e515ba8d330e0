"""Files of policies as sources of FMUs."""

from __future__ import annotations

import hashlib
import json
import re
from dataclasses import dataclass
from pathlib import Path

from seatrial.fmi.components.source import ComponentSource
from seatrial.model.component import Component

from .policy import policy_component
from .policy_file import frozen_policy

_SCRIPT = '''"""{name}: a trained network as an FMU."""

from seatrial.fmi.slave import Slave
from seatrial_kits.learning.policy import policy_component

Policy = policy_component({text!r})


class PolicyFmu(Slave):
    """FMU of the network."""

    component_class = Policy

    def __init__(self, **kwargs):
        super().__init__(**kwargs)
'''


@dataclass(frozen=True)
class PolicySource(ComponentSource):
    """A trained network, which is a component with the ports of its file."""

    text: str = ""
    """The policy, as `frozen_policy` returns it."""

    @property
    def script(self) -> bytes:
        """Text of the FMU's slave script, with all weights."""
        return _SCRIPT.format(name=self.name, text=self.text).encode()

    @property
    def title(self) -> str:
        """What it is, for listings."""
        return json.loads(self.text)["title"] or f"network of {self.name}"

    def component_class(self) -> type[Component]:
        """Return the component."""
        return policy_component(self.text)

    def imported(self, alias: str) -> str:
        """Return the lines of a script that give the class a name."""
        return (
            f"from seatrial_kits.learning.policy import policy_component\n"
            f"{alias} = policy_component({self.text!r})"
        )


def policy_source(path: Path) -> PolicySource:
    """Return the component of a policy's file; see `frozen_policy`. Raises InputError."""
    text = frozen_policy(path)
    stem = re.sub(r"\W", "_", f"policy_{path.stem}", flags=re.ASCII)
    of = hashlib.sha256(text.encode()).hexdigest()[:12]
    return PolicySource(
        path.stem, stem, "seatrial_kits.learning.policy", f"Policy_{of}", str(path), None, text
    )
