"""The calls of NI's gRPC service that a counter or voltage task makes, onto the card."""

import threading
from collections.abc import Callable, Iterator
from typing import Any, Final

import grpc
from nidaqmx._stubs import nidaqmx_pb2 as pb
from nidaqmx.constants import OverwriteMode

from hil_sim.ni_server.card import Card
from hil_sim.ni_server.channels import Wiring
from hil_sim.ni_server.errors import NiCode, NiError, ServerDeadError
from hil_sim.ni_server.tasks import Task
from hil_sim.ni_server.wire import read_answer

SERVICE: Final = "nidaqmx_grpc.NiDAQmx"

# Attribute numbers, as in NI's C header NIDAQmx.h and in nidaqmx.
_DRIVER_VERSION: Final = {0x1272: 24, 0x1923: 8, 0x2F22: 0}
_TASK_NAME: Final = 0x1276
_TASK_CHANNELS: Final = 0x1273
_READ_CHANNELS: Final = 0x217B
_READ_AVAILABLE: Final = 0x1223
_READ_TOTAL_ACQUIRED: Final = 0x192A
_READ_OVERWRITE: Final = 0x1211
_COUNT_EDGES_TERMINALS: Final = (0x18C7, 0x21E1)

Call = Callable[[Any, Any], Any]


class NiDaqService:
    """Answers calls; what is not in its table is answered UNIMPLEMENTED by gRPC.

    Parameters
    ----------
    card
        The card.
    wiring
        What its terminals are connected to.
    die
        Ends the server, for the fault that does so.
    """

    def __init__(self, card: Card, wiring: Wiring, die: Callable[[], None]):
        self._card = card
        self._wiring = wiring
        self._die = die

    def handlers(self) -> Any:
        """Return the table of calls, as gRPC's generic handler."""
        calls: dict[str, Call] = {
            "GetSystemInfoAttributeUInt32": self._driver_version,
            "CreateTask": self._create_task,
            "GetTaskAttributeString": self._task_attribute,
            "CreateCIAngEncoderChan": self._create_angular_encoder,
            "CreateCICountEdgesChan": self._create_count_edges,
            "CreateAIVoltageChan": self._create_voltage,
            "SetChanAttributeString": self._set_terminal,
            "CfgSampClkTiming": self._configure_clock,
            "SetReadAttributeInt32": self._set_overwrite,
            "TaskControl": self._control,
            "UnregisterEveryNSamplesEvent": self._unregister,
            "StartTask": self._start,
            "GetReadAttributeUInt32": self._read_attribute,
            "GetReadAttributeUInt64": self._read_attribute_64,
            "ReadCounterF64Ex": self._reader(pb.ReadCounterF64ExResponse),
            "ReadCounterU32Ex": self._reader(pb.ReadCounterU32ExResponse),
            "ReadAnalogF64": self._reader(pb.ReadAnalogF64Response),
            "StopTask": self._stop,
            "ClearTask": self._clear,
        }
        table = {
            name: grpc.unary_unary_rpc_method_handler(
                self._guarded(call),
                request_deserializer=getattr(pb, f"{name}Request").FromString,
                response_serializer=getattr(pb, f"{name}Response").SerializeToString,
            )
            for name, call in calls.items()
        }
        table["RegisterEveryNSamplesEvent"] = grpc.unary_stream_rpc_method_handler(
            self._events,
            request_deserializer=pb.RegisterEveryNSamplesEventRequest.FromString,
            response_serializer=pb.RegisterEveryNSamplesEventResponse.SerializeToString,
        )
        return grpc.method_handlers_generic_handler(SERVICE, table)

    def _guarded(self, call: Call) -> Call:
        """Turn the card's errors into what the client understands."""

        def answer(request: Any, context: Any) -> Any:
            try:
                self._card.check_alive()
                return call(request, context)
            except NiError as error:
                _refuse(context, error)
            except ServerDeadError:
                self._die()
                context.abort(grpc.StatusCode.UNAVAILABLE, "the server has stopped")

        return answer

    def _task(self, request: Any) -> Task:
        return self._card.tasks.get(request.task.name)

    def _driver_version(self, request: Any, _context: Any) -> Any:
        value = _known(_DRIVER_VERSION, request.attribute_raw)
        return pb.GetSystemInfoAttributeUInt32Response(value=value)

    def _create_task(self, request: Any, context: Any) -> Any:
        task = self._card.tasks.create(request.session_name, context.peer())
        return pb.CreateTaskResponse(task={"name": task.name}, new_session_initialized=True)

    def _task_attribute(self, request: Any, _context: Any) -> Any:
        task = self._task(request)
        resource = "" if task.channel is None else task.channel.resource
        values = {_TASK_NAME: task.name, _TASK_CHANNELS: resource}
        return pb.GetTaskAttributeStringResponse(value=_known(values, request.attribute_raw))

    def _create_angular_encoder(self, request: Any, _context: Any) -> Any:
        self._task(request).channel = self._wiring.angular_encoder(request.counter)
        return pb.CreateCIAngEncoderChanResponse()

    def _create_count_edges(self, request: Any, _context: Any) -> Any:
        self._task(request).channel = self._wiring.count_edges(
            request.counter, request.count_direction_raw, request.initial_count
        )
        return pb.CreateCICountEdgesChanResponse()

    def _create_voltage(self, request: Any, _context: Any) -> Any:
        self._task(request).channel = self._wiring.voltage(request.physical_channel)
        return pb.CreateAIVoltageChanResponse()

    def _set_terminal(self, request: Any, _context: Any) -> Any:
        self._task(request).require_channel()
        _known(dict.fromkeys(_COUNT_EDGES_TERMINALS), request.attribute_raw)
        return pb.SetChanAttributeStringResponse()

    def _configure_clock(self, request: Any, _context: Any) -> Any:
        task = self._task(request)
        task.clock_source = request.source
        task.rate_hz = request.rate
        task.buffer_samples = request.samps_per_chan
        return pb.CfgSampClkTimingResponse()

    def _set_overwrite(self, request: Any, _context: Any) -> Any:
        task = self._task(request)
        _known({_READ_OVERWRITE: None}, request.attribute_raw)
        task.overwrite = request.value_raw == OverwriteMode.OVERWRITE_UNREAD_SAMPLES.value
        return pb.SetReadAttributeInt32Response()

    def _control(self, request: Any, _context: Any) -> Any:
        self._task(request).require_channel()
        return pb.TaskControlResponse()

    def _unregister(self, request: Any, _context: Any) -> Any:
        self._task(request).event_samples = 0
        return pb.UnregisterEveryNSamplesEventResponse()

    def _start(self, request: Any, _context: Any) -> Any:
        self._card.start(self._task(request))
        return pb.StartTaskResponse()

    def _stop(self, request: Any, _context: Any) -> Any:
        self._card.stop(self._task(request))
        return pb.StopTaskResponse()

    def _clear(self, request: Any, _context: Any) -> Any:
        self._card.clear(self._task(request))
        return pb.ClearTaskResponse()

    def _read_attribute(self, request: Any, _context: Any) -> Any:
        values = {_READ_CHANNELS: 1, _READ_AVAILABLE: self._card.available(self._task(request))}
        return pb.GetReadAttributeUInt32Response(value=_known(values, request.attribute_raw))

    def _read_attribute_64(self, request: Any, _context: Any) -> Any:
        values = {_READ_TOTAL_ACQUIRED: self._card.acquired(self._task(request))}
        return pb.GetReadAttributeUInt64Response(value=_known(values, request.attribute_raw))

    def _reader(self, response: Callable[..., Any]) -> Call:
        def read(request: Any, _context: Any) -> Any:
            n_samples = request.num_samps_per_chan
            values = self._card.read(self._task(request), n_samples, request.timeout)
            return read_answer(response, values)

        return read

    def _events(self, request: Any, context: Any) -> Iterator[Any]:
        """Send an event a block, until the task or the client is gone."""
        gone = threading.Event()
        task, registration = self._register(request, context)
        if not context.add_callback(lambda: self._card.wake(gone)):
            gone.set()
        context.send_initial_metadata(())  # the client waits for it before it goes on
        event = pb.RegisterEveryNSamplesEventResponse(
            every_n_samples_event_type_raw=request.every_n_samples_event_type_raw,
            n_samples=request.n_samples,
        )
        try:
            while self._card.next_event(task, gone):
                yield event
        except ServerDeadError:
            self._die()
        finally:
            if gone.is_set():
                self._card.client_gone(task, registration)

    def _register(self, request: Any, context: Any) -> tuple[Task, int]:
        def register(request: Any, _context: Any) -> tuple[Task, int]:
            task = self._task(request)
            if task.event_samples:
                raise NiError(NiCode.EVENT_ALREADY_REGISTERED, "Event is registered already")
            task.event_samples = request.n_samples
            task.registrations += 1
            return task, task.registrations

        registered: tuple[Task, int] = self._guarded(register)(request, context)
        return registered


def _refuse(context: Any, error: NiError) -> None:
    metadata = [("ni-error", str(int(error.code)))]
    if error.samples_read is not None:
        metadata.append(("ni-samps-per-chan-read", str(error.samples_read)))
    context.set_trailing_metadata(metadata)
    context.abort(grpc.StatusCode.UNKNOWN, str(error))


def _known(values: dict[int, Any], attribute: int) -> Any:
    if attribute not in values:
        raise NiError(
            NiCode.ATTRIBUTE_NOT_SUPPORTED, f"Specified property is not supported: 0x{attribute:X}"
        )
    return values[attribute]
