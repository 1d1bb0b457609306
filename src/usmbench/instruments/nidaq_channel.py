"""The connection to an NI gRPC device server."""

from functools import partial
from typing import Any, Final

import grpc
import grpc.experimental

_CONFIGURING_TIMEOUT_S: Final = 10.0
_RUNNING_TIMEOUT_S: Final = 2.0
_RUNNING_CALLS: Final = ("GetReadAttributeUInt64", "StopTask", "ClearTask")
# A server that stands still must not hold the sweep much longer than a card without data.
_READ_MARGIN_S: Final = 0.25
_READS: Final = ("ReadCounterF64Ex", "ReadCounterU32Ex", "ReadAnalogF64")
_MAX_MESSAGE_BYTES: Final = 64 * 2**20


class DeadlineChannel:
    """A channel on which every call but an event stream has a deadline: nidaqmx sets none.

    Each call is given its own. Deadlines in the channel's service configuration would be counted
    from a cycle counter that may be seconds off the wall clock after a suspended machine wakes.

    Parameters
    ----------
    address
        host:port of the server.
    read_timeout_s
        Longest that a read waits for its samples.
    """

    def __init__(self, address: str, read_timeout_s: float):
        self._timeouts_s = dict.fromkeys(_RUNNING_CALLS, _RUNNING_TIMEOUT_S) | dict.fromkeys(
            _READS, _READ_MARGIN_S + read_timeout_s
        )
        self._channel = grpc.insecure_channel(
            address,
            options=[
                ("grpc.enable_http_proxy", 0),
                # The event stream has a thread of its own already, nidaqmx's.
                (grpc.experimental.ChannelOptions.SingleThreadedUnaryStream, 1),
                ("grpc.max_receive_message_length", _MAX_MESSAGE_BYTES),
            ],
        )

    def unary_unary(self, method: str, *serializers: Any, **options: Any) -> Any:
        """Return what makes a call with one answer.

        Parameters
        ----------
        method
            Path of the call, such as "/nidaqmx_grpc.NiDAQmx/StartTask".
        *serializers, **options
            As `grpc.Channel.unary_unary` takes them.
        """
        name = method.rpartition("/")[2]
        timeout_s = self._timeouts_s.get(name, _CONFIGURING_TIMEOUT_S)
        return partial(
            self._channel.unary_unary(method, *serializers, **options), timeout=timeout_s
        )

    def unary_stream(self, method: str, *serializers: Any, **options: Any) -> Any:
        """Return what opens an event stream.

        Parameters
        ----------
        method
            Path of the call.
        *serializers, **options
            As `grpc.Channel.unary_stream` takes them.
        """
        return self._channel.unary_stream(method, *serializers, **options)

    def close(self) -> None:
        """Close the connection; calls under way end."""
        self._channel.close()
