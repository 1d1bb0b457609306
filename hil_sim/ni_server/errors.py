"""Errors of the card, as NI-DAQmx numbers them (nidaqmx.error_codes.DAQmxErrors)."""

from enum import IntEnum


class NiCode(IntEnum):
    """The NI-DAQmx errors that the stand-in card knows."""

    SAMPLES_NOT_YET_AVAILABLE = -200284
    SAMPLES_NO_LONGER_AVAILABLE = -200279
    INVALID_DEVICE = -200220
    ATTRIBUTE_NOT_SUPPORTED = -200197
    CHANNEL_DOES_NOT_EXIST = -200170
    INVALID_TASK = -200088
    INVALID_CLOCK_TERMINAL = -200040
    EVENT_ALREADY_REGISTERED = -200966
    NO_CHANNEL_IN_TASK = -200478
    TASK_NOT_RUNNING = -200973
    RESOURCE_RESERVED = -50103


class NiError(Exception):
    """An error that the client sees as nidaqmx's DaqError or DaqReadError.

    Parameters
    ----------
    code
        NI-DAQmx's number.
    message
        What is wrong.
    samples_read
        Samples that a failed read has read, or None where nothing was to be read.
    """

    def __init__(self, code: NiCode, message: str, *, samples_read: int | None = None):
        super().__init__(message)
        self.code = code
        self.samples_read = samples_read


class ServerDeadError(Exception):
    """The server is to stop answering, by a fault on demand."""
