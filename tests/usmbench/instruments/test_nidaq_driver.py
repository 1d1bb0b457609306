"""The driver's version, here and behind a device server."""

from dataclasses import replace
from typing import Any

import pytest
from nidaqmx.errors import DaqNotFoundError
from nidaqmx.system import System

from usmbench.errors import InputError
from usmbench.instruments.nidaq_driver import driver_version
from usmbench.settings.bench import DaqSettings

HERE = DaqSettings()


def test_the_server_s_driver_is_asked(serve_encoder: Any) -> None:
    server, _ = serve_encoder()
    version = driver_version(replace(HERE, address=server.address))
    assert [part.isdigit() for part in version.split(".")] == [True] * 3


def test_no_server_is_an_input_error_that_names_the_address() -> None:
    with pytest.raises(InputError, match=r"no NI gRPC device server answers at .*127\.0\.0\.1:1"):
        driver_version(replace(HERE, address="127.0.0.1:1"))


def test_no_driver_is_an_input_error_that_says_how_to_do_without(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def absent() -> System:
        raise DaqNotFoundError("no library")

    monkeypatch.setattr(System, "local", staticmethod(absent))
    with pytest.raises(InputError, match=r"not installed on this computer: .*--bench simulated"):
        driver_version(HERE)
