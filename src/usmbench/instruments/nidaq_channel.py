"""The connection to an NI gRPC device server."""

import json
from typing import Any, Final

import grpc
import grpc.experimental

_SERVICE: Final = "nidaqmx_grpc.NiDAQmx"
_CONFIGURING_TIMEOUT_S: Final = 10.0
_RUNNING_TIMEOUT_S: Final = 2.0
_RUNNING_CALLS: Final = (
    "ReadCounterF64Ex",
    "ReadCounterU32Ex",
    "ReadAnalogF64",
    "GetReadAttributeUInt64",
    "StopTask",
    "ClearTask",
)
_MAX_MESSAGE_BYTES: Final = 64 * 2**20


def connect(address: str, read_timeout_s: float) -> Any:
    """Return a channel on which every call but the event stream has a deadline.

    Parameters
    ----------
    address
        host:port of the server.
    read_timeout_s
        Longest that a read waits for its samples.
    """
    return grpc.insecure_channel(
        address,
        options=[
            ("grpc.service_config", json.dumps({"methodConfig": _deadlines(read_timeout_s)})),
            ("grpc.enable_http_proxy", 0),
            # The event stream has a thread of its own already, nidaqmx's.
            (grpc.experimental.ChannelOptions.SingleThreadedUnaryStream, 1),
            ("grpc.max_receive_message_length", _MAX_MESSAGE_BYTES),
        ],
    )


def _deadlines(read_timeout_s: float) -> list[dict[str, Any]]:
    """Return gRPC's method configuration: nidaqmx sets no deadlines, and this costs no time."""
    running = [{"service": _SERVICE, "method": method} for method in _RUNNING_CALLS]
    return [
        {"name": [{}], "timeout": f"{_CONFIGURING_TIMEOUT_S:.3f}s"},
        {"name": running, "timeout": f"{_RUNNING_TIMEOUT_S + read_timeout_s:.3f}s"},
        {"name": [{"service": _SERVICE, "method": "RegisterEveryNSamplesEvent"}]},
    ]
