from typing import Any

import pytest

from usmbench.sweep.drive import CommandedDrive, Setting


def test_only_what_has_changed_is_sent(fake: Any) -> None:
    drive = CommandedDrive(fake, fake)
    drive.apply(Setting(10.0, 41_000.0))
    drive.apply(Setting(20.0, 41_000.0))
    drive.apply(Setting(20.0, 41_000.0, sweep=1))
    drive.apply(Setting(20.0, 41_500.0))
    drive.rest()
    drive.apply(Setting(5.0, 41_500.0))
    assert fake.calls == [
        *("set_drive 41000 10", "on", "phase 20", "set_drive 41500 20"),
        *("off", "set_drive 41500 0", "set_drive 41500 5", "on"),
    ]


def test_before_the_first_command_rest_is_just_off(fake: Any) -> None:
    CommandedDrive(fake, fake).rest()
    assert fake.calls == ["off"]


@pytest.mark.parametrize(
    ("end_sample", "phase_deg"), [(5000, 0.0), (5100, 0.0), (5101, 30.0), (5200, 30.0)]
)
def test_a_window_belongs_to_the_setting_at_its_end(
    fake: Any, end_sample: int, phase_deg: float
) -> None:
    fake.clock_samples, fake.command_samples = 5000, 100
    drive = CommandedDrive(fake, fake)
    drive.apply(Setting(30.0, 41_000.0))  # set_drive and on: from sample 5000 to 5200
    assert drive.complete_at == 5200
    setting = drive.in_force(end_sample)
    assert (setting.phase_deg, setting.drive_on) == (phase_deg, int(phase_deg > 0))


def test_in_lock_step_the_next_window_is_the_new_settings(fake: Any) -> None:
    fake.clock_samples = 3000
    drive = CommandedDrive(fake, fake)
    drive.apply(Setting(30.0, 41_000.0))
    assert drive.in_force(3000).phase_deg == 0.0
    assert drive.in_force(4000).phase_deg == 30.0


def test_rest_takes_the_phase_to_zero_in_the_rows(fake: Any) -> None:
    drive = CommandedDrive(fake, fake)
    drive.apply(Setting(90.0, 41_000.0, 0.1, 3))
    drive.rest()
    assert drive.in_force(1000) == Setting(0.0, 41_000.0, 0.1, 3, 0)


def test_a_sign_of_life_goes_out_only_after_silence(fake: Any) -> None:
    drive = CommandedDrive(fake, fake)
    for end_sample in range(1000, 101_000, 1000):
        fake.clock_samples = end_sample
        if end_sample == 40_000:
            drive.apply(Setting(30.0, 41_000.0))
        drive.keep_alive(end_sample, 25_000)
    assert fake.contact_samples == [25_000, 40_000, 40_000, 65_000, 90_000]


def test_a_setting_that_changes_nothing_is_no_sign_of_life(fake: Any) -> None:
    drive = CommandedDrive(fake, fake)
    setting = Setting(20.0, 41_000.0)
    for end_sample in range(0, 100_000, 1000):
        fake.clock_samples = end_sample
        drive.apply(setting)
        drive.keep_alive(end_sample, 25_000)
    assert fake.calls.count("heartbeat") == 3
