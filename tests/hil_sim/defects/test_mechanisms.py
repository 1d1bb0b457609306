"""Each mechanism does on the motor what its physics says, and nothing where it is no size."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from hil_sim.defects import CATALOGUE, Defect, defective_plant, parse_defect
from hil_sim.defects.defect import SignedDefect
from hil_sim.defects.paths import WiredPlant
from hil_sim.plant import PlantParameters
from hil_sim.signals import Drive
from usmbench.errors import InputError

RATE_HZ = 10_000.0
COUNT_RAD = 2.0 * math.pi / 2000.0
QUIET = replace(PlantParameters(), rotor=replace(PlantParameters().rotor, noise_nm=0.0))


def at(phase_deg: float, amplitude: float = 1.0) -> Drive:
    return Drive(41_000.0, phase_deg, amplitude, amplitude)


def started(*defects: str, phase_deg: float, seed: int = 0) -> WiredPlant:
    plant = defective_plant(QUIET, [parse_defect(text) for text in defects], seed=seed)
    plant.drive(0.0, at(phase_deg))
    plant.sample(int(0.2 * RATE_HZ), RATE_HZ)
    return plant


def mean_rad_s(plant: WiredPlant, duration_s: float = 0.4) -> float:
    position = plant.sample(int(duration_s * RATE_HZ), RATE_HZ).position
    return float(position[-1] - position[0]) * COUNT_RAD / (duration_s - 1.0 / RATE_HZ)


def speed_rad_s(*defects: str, phase_deg: float = 90.0, seed: int = 0) -> float:
    return mean_rad_s(started(*defects, phase_deg=phase_deg, seed=seed))


def windows_rad_s(plant: WiredPlant, windows: int) -> NDArray[np.float64]:
    position = plant.sample(int(0.01 * windows * RATE_HZ) + 1, RATE_HZ).position
    turned: NDArray[np.float64] = np.diff(position[:: int(0.01 * RATE_HZ)]) * COUNT_RAD / 0.01
    return turned


@pytest.mark.parametrize(
    ("defect", "phase_deg", "ratio"),
    [
        ("leaning_teeth=10", -90.0, 0.9),
        ("other_code_wheel=25", 90.0, 1.05),
        ("worn_contact=10", 90.0, 1.0 / 1.1),
        ("dragging_bearing=30", 90.0, 0.97),
        ("hanging_weight=30", 90.0, 1.03),
        ("hanging_weight=30", -90.0, 0.97),
        ("soft_supply=10", 90.0, 0.89),
        ("weak_generator=10", 90.0, 0.95),
        ("off_crystal=1000", 90.0, 0.946),
        ("mode_hop=10", 45.0, 0.76),
        ("singing_cage=60", 40.0, 0.914),
    ],
)
def test_it_changes_the_settled_speed(defect: str, phase_deg: float, ratio: float) -> None:
    changed = speed_rad_s(defect, phase_deg=phase_deg) / speed_rad_s(phase_deg=phase_deg)
    assert changed == pytest.approx(ratio, abs=0.2 * abs(1.0 - ratio))


@pytest.mark.parametrize(
    ("defect", "phase_deg"),
    [("leaning_teeth=10", 90.0), ("mode_hop=10", 70.0), ("sticky_friction=50", 90.0)],
)
def test_it_leaves_the_rest_alone(defect: str, phase_deg: float) -> None:
    assert speed_rad_s(defect, phase_deg=phase_deg) == speed_rad_s(phase_deg=phase_deg)


def test_a_late_amplifier_shifts_the_phase() -> None:
    # 677.5 ns are 10° at 41 kHz.
    late = speed_rad_s("amplifier_delay=677.5", phase_deg=50.0)
    assert late == pytest.approx(speed_rad_s(phase_deg=40.0), rel=1e-3)


def test_an_aged_shifter_turns_too_far() -> None:
    too_far = speed_rad_s("aged_shifter=25", phase_deg=-32.0)
    assert too_far == pytest.approx(speed_rad_s(phase_deg=-40.0), rel=1e-3)


def test_missing_bits_cut_the_phase_down_to_a_coarse_grid() -> None:
    grid_deg = 360.0 / 4096.0 * 2**7
    assert speed_rad_s("missing_phase_bits=7", phase_deg=3.9 * grid_deg) == pytest.approx(
        speed_rad_s(phase_deg=3.0 * grid_deg), rel=1e-3
    )
    assert speed_rad_s("missing_phase_bits=7", phase_deg=-3.9 * grid_deg) == pytest.approx(
        speed_rad_s(phase_deg=-4.0 * grid_deg), rel=1e-3
    )


def test_a_register_is_short_whatever_is_said_first() -> None:
    grid_deg, late = 360.0 / 4096.0 * 2**7, "amplifier_delay=677.5"
    shifted = speed_rad_s(phase_deg=5.0 * grid_deg - 10.0)
    for defects in (("missing_phase_bits=7", late), (late, "missing_phase_bits=7")):
        speed = speed_rad_s(*defects, phase_deg=5.9 * grid_deg)
        assert speed == pytest.approx(shifted, rel=2e-3)


def test_sticky_friction_starts_later_than_it_stops() -> None:
    def moved_at(phases_deg: Sequence[float]) -> list[bool]:
        plant, moved = defective_plant(QUIET, [parse_defect("sticky_friction=150")]), []
        for k, phase_deg in enumerate(phases_deg):
            plant.drive(0.3 * k, at(phase_deg))
            plant.sample(int(0.2 * RATE_HZ), RATE_HZ)
            moved.append(abs(mean_rad_s(plant, 0.1)) > 0.1)
        return moved

    phases_deg = [float(k) for k in range(2, 26, 2)]
    up, down = moved_at(phases_deg), moved_at(phases_deg[::-1])[::-1]
    assert sum(down) > sum(up) > 0


def test_a_queue_delays_commands() -> None:
    counts = []
    for defects in ((), ("command_queue=30",)):
        plant = defective_plant(QUIET, [parse_defect(text) for text in defects])
        plant.drive(0.0, at(90.0))
        counts.append(plant.sample(4000, RATE_HZ).position)
    assert np.array_equal(counts[1][300:], counts[0][:-300])
    assert not np.any(counts[1][:300])


def test_a_flywheel_takes_longer_to_get_up_to_speed() -> None:
    late = []
    for defects in ((), ("flywheel=100",)):
        plant = defective_plant(QUIET, [parse_defect(text) for text in defects])
        plant.drive(0.0, at(90.0))
        plant.sample(2000, RATE_HZ)
        counts = plant.sample(1000, RATE_HZ).position
        speed = (counts[-1] - counts[0]) / 999
        late.append(0.2 - counts[0] / speed / RATE_HZ)
    # Twice the inertia, twice the time constant of some 3 ms.
    assert late[1] - late[0] == pytest.approx(3.5e-3, rel=0.3)


def test_lossy_ceramic_lets_the_speed_drift() -> None:
    drifts = []
    for defects in ((), ("lossy_ceramic=20",)):
        plant = started(*defects, phase_deg=90.0)
        early = mean_rad_s(plant)
        plant.sample(int(15 * RATE_HZ), RATE_HZ)
        drifts.append(mean_rad_s(plant) / early - 1.0)
    assert abs(drifts[1]) > 3.0 * abs(drifts[0])


@pytest.mark.parametrize(("defect", "per_turn"), [("eccentric_disc=300", 1), ("bent_wheel=30", 2)])
def test_a_disc_that_is_off_ripples_with_the_turn(defect: str, per_turn: int) -> None:
    ripple = {}
    for defects in ((), (defect,)):
        plant = started(*defects, phase_deg=90.0)
        seen = windows_rad_s(plant, 200)
        angle_rad = np.cumsum(seen) * 0.01
        waves = [abs(np.mean((seen - seen.mean()) * np.exp(1j * k * angle_rad))) for k in (1, 2)]
        ripple[defects] = waves
    assert ripple[defect,][per_turn - 1] > 10.0 * ripple[()][per_turn - 1]
    assert ripple[defect,][per_turn - 1] > 10.0 * ripple[defect,][2 - per_turn]


def test_a_disc_error_does_not_change_the_mean_over_turns() -> None:
    assert mean_rad_s(started("eccentric_disc=300", phase_deg=90.0), 5.0) == pytest.approx(
        mean_rad_s(started(phase_deg=90.0), 5.0), rel=2e-3
    )


def test_the_filter_loses_counts_at_high_speed_only() -> None:
    defect = "slow_input_filter=640"
    assert speed_rad_s(defect, phase_deg=90.0) < 0.9 * speed_rad_s(phase_deg=90.0)
    assert speed_rad_s(defect, phase_deg=30.0) == speed_rad_s(phase_deg=30.0)


@pytest.mark.parametrize("phase_deg", [90.0, -90.0])
def test_a_scratch_takes_its_lines_once_a_turn_either_way(phase_deg: float) -> None:
    whole, scratched = (
        started(*defects, phase_deg=phase_deg).sample(int(3 * RATE_HZ), RATE_HZ).position
        for defects in ((), ("scratched_disc=2",))
    )
    lost = np.diff(whole - scratched)
    assert set(np.unique(np.sign(phase_deg) * lost)) == {0, 1}
    turns = (whole[-1] - whole[0]) / 2000.0
    assert np.sum(lost) == pytest.approx(8.0 * turns, abs=8.0)
    assert np.ptp(whole[1:][lost != 0] % 2000) < 8


def test_spikes_stay_in_the_count() -> None:
    plant = started("spikes=200", phase_deg=0.0)
    counts = plant.sample(int(2 * RATE_HZ), RATE_HZ).position
    steps = np.diff(counts)
    assert 300 < np.count_nonzero(steps) < 500
    assert set(np.unique(steps)) <= {-2, -1, 0, 1, 2}
    other = started("spikes=200", phase_deg=0.0, seed=1)
    assert not np.array_equal(counts, other.sample(int(2 * RATE_HZ), RATE_HZ).position)


def test_a_dead_direction_counts_up_either_way() -> None:
    backward = speed_rad_s("dead_direction", phase_deg=-90.0)
    assert backward == -speed_rad_s(phase_deg=-90.0) > 5.0


def test_swapped_wires_count_the_other_way() -> None:
    assert speed_rad_s("swapped_wires", phase_deg=60.0) == -speed_rad_s(phase_deg=60.0) < -5.0


def test_swapped_outputs_turn_it_the_other_way() -> None:
    backward = speed_rad_s("swapped_outputs", phase_deg=60.0)
    assert backward == pytest.approx(speed_rad_s(phase_deg=-60.0), rel=0.01)
    assert backward < -5.0


def test_backlash_waits_after_a_reversal() -> None:
    turned = []
    for defects in ((), ("loose_coupling=40",)):
        plant = started(*defects, phase_deg=90.0)
        plant.drive(0.2, at(-90.0))
        before = plant.sample(1, RATE_HZ).position[0]
        after = plant.sample(int(0.4 * RATE_HZ), RATE_HZ).position
        assert after.max() - before < 200
        turned.append(after[-1] - after.max())
    assert turned[1] - turned[0] == 40


def unevenness_counts(plant: WiredPlant, duration_s: float) -> float:
    position = plant.sample(int(duration_s * RATE_HZ), RATE_HZ).position
    ticks = np.arange(position.size)
    return float(np.std(position - np.polyval(np.polyfit(ticks, position, 1), ticks)))


@pytest.mark.parametrize(
    ("defect", "counts"), [("seamed_belt=40", 10.0), ("humming_supply=10", 0.5)]
)
def test_it_swings_the_shaft(defect: str, counts: float) -> None:
    # An even motion is known to 1/sqrt(12) of a count.
    assert unevenness_counts(started(phase_deg=90.0), 3.0) < 0.4
    assert unevenness_counts(started(defect, phase_deg=90.0), 3.0) > counts


def test_the_cable_rubs_for_some_seconds() -> None:
    plant = started("rubbing_cable=60", phase_deg=90.0)
    free = mean_rad_s(plant)
    plant.sample(int(9.5 * RATE_HZ), RATE_HZ)
    rubbed = mean_rad_s(plant)
    plant.sample(int(4.0 * RATE_HZ), RATE_HZ)
    assert rubbed < 0.96 * free
    assert mean_rad_s(plant) == pytest.approx(free, rel=0.01)


def test_a_dry_bearing_widens_the_dead_zone_and_spares_the_rest() -> None:
    phase_deg = 8.0
    assert speed_rad_s(phase_deg=phase_deg) > 0.0
    assert speed_rad_s("dry_bearing=150", phase_deg=phase_deg) < speed_rad_s(phase_deg=phase_deg)
    assert speed_rad_s("dry_bearing=150") == pytest.approx(speed_rad_s(), rel=1e-3)


def test_a_soft_coupling_swings_after_a_step_and_then_turns_as_before() -> None:
    swings, settled = [], []
    for defects in ((), ("soft_coupling=100",)):
        plant = defective_plant(QUIET, [parse_defect(text) for text in defects])
        plant.drive(0.0, at(90.0))
        plant.sample(300, RATE_HZ)
        swings.append(unevenness_counts(plant, 0.1))
        plant.sample(5000, RATE_HZ)
        settled.append(mean_rad_s(plant))
    assert swings[1] > 1.5 * swings[0]
    assert settled[1] == pytest.approx(settled[0], rel=2e-3)


@pytest.mark.parametrize("kind", CATALOGUE.values(), ids=lambda kind: kind.mechanism)
def test_a_draw_has_its_unit_its_sign_and_a_size_that_grows(kind: type[Defect]) -> None:
    rng = np.random.default_rng(5)
    sizes = [abs(kind.of_strength(strength, rng).size) for strength in (0.3, 1.0, 10.0, 30.0)]
    assert sizes == sorted(sizes)
    assert sizes[0] > 0.0
    assert kind.least <= -sizes[-1] * issubclass(kind, SignedDefect)
    assert sizes[-1] <= kind.most
    assert kind.mechanism
    assert kind.__doc__


@pytest.mark.parametrize("size", ["nan", "inf", "-1e300", "1e9", "much", "", "-0.1"])
def test_what_is_no_size_is_refused_with_the_unit(size: str) -> None:
    with pytest.raises(InputError, match=r"in µm between 0 and 11000, such as"):
        parse_defect(f"eccentric_disc={size}")


@pytest.mark.parametrize("text", ["spikes=-1", "missing_phase_bits=-3", "command_queue=-5"])
def test_a_size_that_the_mechanism_cannot_have_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=rf"defect '{text}': '-\d' is no size; give a number in"):
        parse_defect(text)


@pytest.mark.parametrize("kind", CATALOGUE.values(), ids=lambda kind: kind.mechanism)
@pytest.mark.parametrize("end", ["least", "most"])
def test_a_motor_runs_with_any_size_that_is_taken(kind: type[Defect], end: str) -> None:
    plant = started(f"{kind.mechanism}={getattr(kind, end)}", phase_deg=90.0)
    assert np.isfinite(mean_rad_s(plant, 0.1))
