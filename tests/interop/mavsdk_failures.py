"""MAVSDK's failure plugin at a vehicle: ``python -m tests.interop.mavsdk_failures URL DIALECT``."""

from __future__ import annotations

import asyncio
import sys

from mavsdk.asyncio.plugins.failure.failure import FailureAsync
from mavsdk.asyncio.plugins.param.param import ParamAsync
from mavsdk.plugins.failure import FailureType, FailureUnit

from .mavsdk_station import answered, connected, refused

NO_FIX, RTK_FIXED = 1, 6


async def main(url: str, dialect: str) -> None:
    """Break and repair, see it, and be refused what there is not."""
    async with connected(url) as station:
        failure, parameters = FailureAsync(station.system), ParamAsync(station.system)
        await station.receives("gps_info", "healthy", fix_type=RTK_FIXED)
        for kind, fix in ((FailureType.OFF, NO_FIX), (FailureType.OK, RTK_FIXED)):
            await answered(failure.inject(FailureUnit.SENSOR_GPS, kind, 0))
            await station.receives("gps_info", kind.name, fix_type=fix)
        await answered(failure.inject(FailureUnit.SYSTEM_MOTOR, FailureType.STUCK, 2))
        await station.reads("Failure: motor2 stuck")
        vio = failure.inject(FailureUnit.SENSOR_VIO, FailureType.OFF, 0)
        assert await refused(vio) == "UNSUPPORTED"
        if dialect == "px4":
            await answered(parameters.set_param_int("SYS_FAILURE_EN", 0))
            off = failure.inject(FailureUnit.SENSOR_GPS, FailureType.OFF, 0)
            assert await refused(off) in ("DISABLED", "DENIED")


if __name__ == "__main__":
    asyncio.run(main(*sys.argv[1:]))
