"""Steps as an action: three services and two topics, as rcl_action has them below ``_action``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from .messages.packing import packed
from .transport import Call, Transport

_PACKAGE = "simulation_interfaces"
GOAL, _ASKED = (f"{_PACKAGE}/action/SimulateSteps_{part}" for part in ("SendGoal", "GetResult"))
_FEEDBACK = f"{_PACKAGE}/msg/SimulateSteps_FeedbackMessage"
_CANCEL = "action_msgs/srv/CancelGoal"
_STATUS = "action_msgs/msg/GoalStatusArray"
_UNKNOWN, _EXECUTING, _SUCCEEDED, _CANCELED, _ABORTED = 0, 2, 4, 5, 6
"""Status of a goal, as in action_msgs/GoalStatus."""
_DONE, _NO_SUCH_GOAL, _OVER = 0, 2, 3
"""Answers to a cancellation."""
_KEPT = 10
"""Goals that are over and whose results are kept."""
Result = Mapping[str, Any]


@dataclass(eq=False)
class Goal:
    """One goal: its state, and the calls that wait for its result."""

    identity: bytes
    accepted_ns: int
    steps: int
    status: int = _EXECUTING
    result: Result = field(default_factory=dict)
    waiting: list[Call] = field(default_factory=list)

    @property
    def info(self) -> Mapping[str, Any]:
        """The goal as action_msgs/GoalInfo."""
        return {"goal_id": {"uuid": self.identity}, "stamp": self.accepted_ns}


class StepsAction:
    """The action ``name`` of the type SimulateSteps.

    ``begin`` begins that many steps, and returns the result of a goal that cannot be; it has
    what to call after each step, with the number left, and the result behind the last one.
    ``cancel`` leaves the steps that are left, and returns the result of that.
    """

    def __init__(
        self,
        transport: Transport,
        name: str,
        begin: Callable[[int, Callable[[int, Result], None]], Result | None],
        cancel: Callable[[], Result],
    ) -> None:
        self._begin, self._cancel = begin, cancel
        base = f"{name}/_action"
        self._services = [
            transport.service(f"{base}/send_goal", GOAL, self._on_goal),
            transport.service(f"{base}/get_result", _ASKED, self._on_result),
            transport.service(f"{base}/cancel_goal", _CANCEL, self._on_cancel),
        ]
        self._feedback = transport.writer(f"{base}/feedback", _FEEDBACK)
        self._status = transport.writer(f"{base}/status", _STATUS, "latched")
        self._goals: list[Goal] = []
        self._now_ns = 0

    def serve(self, now_ns: int) -> None:
        """Answer the calls that have come."""
        self._now_ns = now_ns
        for service in self._services:
            service.serve()

    def _on_goal(self, call: Call) -> None:
        goal = Goal(_uuid(call.request.goal_id), self._now_ns, int(call.request.goal.steps))
        known = self._found(goal.identity) is not None
        call.answer({"accepted": not known, "stamp": self._now_ns})
        if known:
            return
        self._goals.append(goal)
        refused = self._begin(goal.steps, lambda left, result: self._progress(goal, left, result))
        if refused is not None:
            self._finish(goal, _ABORTED, refused)
        else:
            self._tell()

    def _progress(self, goal: Goal, left: int, result: Result) -> None:
        counts = {"completed_steps": goal.steps - left, "remaining_steps": left}
        told = {"goal_id": {"uuid": goal.identity}, "feedback": counts}
        self._feedback.write(packed(_FEEDBACK, told))
        if not left:
            self._finish(goal, _SUCCEEDED, result)

    def _on_result(self, call: Call) -> None:
        goal = self._found(_uuid(call.request.goal_id))
        if goal is None:
            call.answer({"status": _UNKNOWN})
        elif goal.status == _EXECUTING:
            goal.waiting.append(call)
        else:
            call.answer({"status": goal.status, "result": goal.result})

    def _on_cancel(self, call: Call) -> None:
        """Cancel the goal that is named, or with an identity of zeros the one that acts."""
        identity = _uuid(call.request.goal_info.goal_id)
        goal = self._found(identity) if any(identity) else None
        acting = [g for g in self._goals if g.status == _EXECUTING and (g is goal or not goal)]
        if any(identity) and not acting:
            call.answer({"return_code": _NO_SUCH_GOAL if goal is None else _OVER})
            return
        call.answer({"return_code": _DONE, "goals_canceling": [each.info for each in acting]})
        for each in acting:
            self._finish(each, _CANCELED, self._cancel())

    def _finish(self, goal: Goal, status: int, result: Result) -> None:
        goal.status, goal.result = status, result
        over = [g for g in self._goals if g.status != _EXECUTING and g is not goal]
        acting = [g for g in self._goals if g.status == _EXECUTING]
        self._goals = [*over, goal][-_KEPT:] + acting
        self._tell()
        for call in goal.waiting:
            call.answer({"status": status, "result": result})
        goal.waiting.clear()

    def _tell(self) -> None:
        states = [{"goal_info": each.info, "status": each.status} for each in self._goals]
        self._status.write(packed(_STATUS, {"status_list": states}))

    def _found(self, identity: bytes) -> Goal | None:
        return next((each for each in self._goals if each.identity == identity), None)


def _uuid(message: Any) -> bytes:
    return bytes(int(each) for each in message.uuid)
