"""The simulator to other programs: the standard simulation_interfaces, as far as it applies."""

from __future__ import annotations

import re
import time
from collections.abc import Callable, Mapping
from typing import Any

from seatrial.links.interruption import Interruption
from seatrial.links.watchdog import Waiting
from seatrial.physics.craft.kinematics import to_ned

from .action import GOAL, StepsAction
from .frames import enu
from .ports import Ros2Ports
from .published import MAP, pose
from .transport import Call, Handler, Transport

PLAYING, PAUSED = 1, 2
UNSUPPORTED, OK, NOT_FOUND, INCORRECT_STATE, FAILED = range(5)
"""Results of the standard."""
_ALREADY = 101
_PACKAGE = "simulation_interfaces"
FEATURES = {
    "ENTITY_STATE_GETTING": 10,
    "SIMULATION_STATE_GETTING": 24,
    "SIMULATION_STATE_SETTING": 25,
    "SIMULATION_STATE_PAUSE": 26,
    "STEP_SIMULATION_SINGLE": 31,
    "STEP_SIMULATION_MULTIPLE": 32,
    "STEP_SIMULATION_ACTION": 33,
}
_STATES = {0: "stopped", PLAYING: "playing", PAUSED: "paused", 3: "quitting"}
_OF_THE_RIG = (
    *("SpawnEntity", "DeleteEntity", "GetSpawnables"),
    *("LoadWorld", "GetAvailableWorlds", "GetCurrentWorld"),
)
_MOST_STEPS = 1_000_000
Progress = Callable[[int, Mapping[str, Any]], None]
"""Called after each step, with the number left, and the result of the last one."""
_POLL_S = 0.005


class Simulator:
    """Services below ``name``: state, steps, and the vehicle as an entity.

    A paused simulation stands still in the link's step, and answers calls. Steps are the link's
    sample periods, taken by the service or the action (`StepsAction`). What cannot be done here
    (reset, spawning, setting a state) is answered as the standard has it:
    RESULT_FEATURE_UNSUPPORTED, and a sentence.
    """

    def __init__(self, transport: Transport, name: str, link: Ros2Ports, entity: str) -> None:
        self._link, self._entity = link, entity
        self.paused = False
        self.paused_s = 0.0
        """Wall time that it stood still, s."""
        self._stepping: tuple[int, Progress] | None = None
        handlers: Mapping[str, Handler] = {
            "GetSimulatorFeatures": self._features,
            "GetSimulationState": self._state,
            "SetSimulationState": self._set_state,
            "StepSimulation": self._step,
            "GetEntities": self._entities,
            "GetEntityState": self._entity_state,
            "GetEntitiesStates": self._entities_states,
            "SetEntityState": _unsupported("a vehicle moves by its equations alone"),
            "ResetSimulation": _unsupported("a run is begun again by seatrial run"),
            **dict.fromkeys(_OF_THE_RIG, _unsupported("vehicles and world are those of the rig")),
        }
        offered = {kind: transport.lacks(f"{_PACKAGE}/srv/{kind}") for kind in handlers}
        action = transport.lacks(GOAL)
        self.lacking = [why for why in (*offered.values(), action) if why]
        """Why services are missing: the workspace has an older package, or none."""
        self._services = [
            transport.service(f"{name}/{_snake(kind)}", f"{_PACKAGE}/srv/{kind}", act)
            for kind, act in handlers.items()
            if not offered[kind]
        ]
        self._action: StepsAction | None = None
        if not action:
            steps = f"{name}/simulate_steps"
            self._action = StepsAction(transport, steps, self._begin, self._leave)
        self._now_ns = 0

    def serve(self, now_ns: int) -> None:
        """Answer the calls that have come."""
        self._now_ns = now_ns
        for service in self._services:
            service.serve()
        if self._action is not None:
            self._action.serve(now_ns)

    def stand_still(self, now_ns: int, others: Callable[[], None]) -> None:
        """Stand still while it is paused and no step is asked for; ``others`` are served too."""
        if self._stepping is not None:
            left, progress = self._stepping
            self._stepping = (left - 1, progress) if left > 1 else None
            progress(left - 1, _result(OK))
            if left > 1:
                return
        begun, waiting = time.monotonic(), Waiting()
        if not self.paused:
            return
        with Interruption() as interruption:
            while self.paused and self._stepping is None and not interruption.requested:
                waiting.note()
                time.sleep(_POLL_S)
                self.serve(now_ns)
                others()
        self.paused_s += time.monotonic() - begun

    # ------------------------------------------------------------------ calls

    def _features(self, call: Call) -> None:
        about = "seatrial: marine vehicles; one vehicle per link, begun by seatrial run"
        call.answer({"features": {"features": [*FEATURES.values()], "custom_info": about}})

    def _state(self, call: Call) -> None:
        state = PAUSED if self.paused else PLAYING
        call.answer({"state": {"state": state}, **_result(OK)})

    def _set_state(self, call: Call) -> None:
        wanted = int(call.request.state.state)
        if wanted not in (PLAYING, PAUSED):
            named = _STATES.get(wanted, f"state {wanted}")
            call.answer(_result(UNSUPPORTED, f"{named} is not to be had: playing or paused are"))
        elif self._stepping is not None:
            call.answer(_result(INCORRECT_STATE, "steps are being taken"))
        elif (wanted == PAUSED) == self.paused:
            call.answer(_result(_ALREADY, f"it is {_STATES[wanted]} already"))
        else:
            self.paused = wanted == PAUSED
            call.answer(_result(OK))

    def _step(self, call: Call) -> None:
        def progress(left: int, result: Mapping[str, Any]) -> None:
            if not left:
                call.answer(result)

        refused = self._begin(int(call.request.steps), progress, INCORRECT_STATE)
        if refused is not None:
            call.answer(refused)

    def _begin(
        self, steps: int, progress: Progress, not_paused: int = FAILED
    ) -> Mapping[str, Any] | None:
        """Begin steps; return the result of a call that cannot be followed."""
        if not self.paused or self._stepping is not None:
            return _result(not_paused, "steps are taken of a paused simulation")
        if not 1 <= steps <= _MOST_STEPS:
            return _result(FAILED, f"{steps} steps were asked for, allowed 1 to {_MOST_STEPS}")
        self._stepping = steps, progress
        return None

    def _leave(self) -> Mapping[str, Any]:
        """Leave the steps that are left."""
        self._stepping = None
        return _result(FAILED, "the steps were cancelled")

    def _entities(self, call: Call) -> None:
        found, why = self._found(call.request.filters)
        call.answer({"entities": found, **_result(FAILED if why else OK, why)})

    def _entities_states(self, call: Call) -> None:
        found, why = self._found(call.request.filters)
        states = [self._motion() for _ in found]
        call.answer({"entities": found, "states": states, **_result(FAILED if why else OK, why)})

    def _entity_state(self, call: Call) -> None:
        if call.request.entity == self._entity:
            call.answer({"state": self._motion(), **_result(OK)})
        else:
            said = f"there is no {call.request.entity!r}, {self._entity!r} is the entity"
            call.answer(_result(NOT_FOUND, said))

    def _found(self, filters: Any) -> tuple[list[str], str]:
        try:
            matches = re.search(filters.filter, self._entity)
        except re.error as error:
            return [], f"the filter {filters.filter!r} is no regular expression: {error}"
        apart = filters.categories or filters.tags.tags
        return ([self._entity] if matches and not apart else []), ""

    def _motion(self) -> Mapping[str, Any]:
        """Return the true motion, all in map."""
        truth = self._link.true_motion()
        rates = enu(to_ned(truth.attitude, truth.rates))
        return {
            "header": {"stamp": self._now_ns, "frame_id": MAP},
            "pose": pose(truth),
            "twist": {"linear": enu(truth.velocity_n), "angular": rates},
        }


def _unsupported(why: str) -> Handler:
    return lambda call: call.answer(_result(UNSUPPORTED, why))


def _result(code: int, message: str = "") -> Mapping[str, Any]:
    return {"result": {"result": code, "error_message": message}}


def _snake(kind: str) -> str:
    return re.sub(r"(?<!^)(?=[A-Z])", "_", kind).lower()
