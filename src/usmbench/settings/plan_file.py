"""Plan files: read, checked, and errors that name the line."""

from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from usmbench.errors import InputError
from usmbench.settings.phases import listed, phases_of
from usmbench.settings.plan import (
    DwellSettings,
    Excitation,
    Pass,
    Plan,
    PlanLimits,
    Settle,
    WarmUp,
)
from usmbench.settings.schema import check, did_you_mean
from usmbench.settings.yaml_source import Source, parse_source, read_source

MAX_PHASE_DEG = 180.0


def shipped_plans() -> tuple[str, ...]:
    """Return the names of the plans that ship with usmbench."""
    folder = resources.files(__package__).joinpath("plans")
    names = (file.name for file in folder.iterdir())
    return tuple(sorted(name.removesuffix(".yaml") for name in names if name.endswith(".yaml")))


def load_plan(file_or_name: str) -> Plan:
    """Read a plan file, or a plan that ships.

    Parameters
    ----------
    file_or_name
        A file, or where there is none of that name, the name of a plan that ships.

    Raises
    ------
    usmbench.errors.InputError
        There is no such plan, or it is wrong; names the line and the mend.
    """
    path = Path(file_or_name)
    if path.is_file():
        return parse_plan(read_source(path))
    shipped = shipped_plans()
    if file_or_name in shipped:
        file = resources.files(__package__).joinpath("plans", f"{file_or_name}.yaml")
        return parse_plan(parse_source(file.read_text("utf-8"), f"{file_or_name}.yaml"))
    hint = did_you_mean(file_or_name, shipped)
    raise InputError(f"no plan file {file_or_name}, and no plan of that name ships; {hint}")


def parse_plan(source: Source) -> Plan:
    """Return the plan a document holds.

    Parameters
    ----------
    source
        The document of a plan file, or of the plan in a run.yaml.

    Raises
    ------
    usmbench.errors.InputError
        The plan is wrong; names the line and the mend.
    """
    check(source, "plan")
    document: dict[str, Any] = source.document
    plan = Plan(
        source=source,
        name=document.get("name", Path(source.file).stem),
        frequency_hz=listed(document["frequency_hz"]),
        torque_nm=listed(document.get("torque_nm", 0.0)),
        ask_operator=operator_sets_load(document),
        outer=document.get("outer", "torque_nm"),
        warm_up=_warm_up(document.get("warm_up")),
        passes=tuple(_pass(source, index) for index in range(len(document.get("passes", ())))),
        excitation=_excitation(document.get("excitation")),
        dwell=_dwell(document.get("dwell", {})),
        limits=PlanLimits(**document.get("limits", {})),
    )
    _check_consistent(plan)
    return plan


def operator_sets_load(document: Mapping[str, Any]) -> bool:
    """Return whether a plan has the operator set each load; else it is there and stays.

    Parameters
    ----------
    document
        What the plan says; one in a run.yaml may say anything.
    """
    return document.get("load") == "operator"


def _pass(source: Source, index: int) -> Pass:
    document = dict(source.document["passes"][index])
    place = ("passes", index, "phase_deg")
    document["phase_deg"] = phases_of(source, place, document["phase_deg"])
    return Pass(**document)


def _warm_up(document: dict[str, Any] | None) -> WarmUp | None:
    if document is None:
        return None
    return WarmUp(**{key: float(value) for key, value in document.items()})


def _excitation(document: dict[str, Any] | None) -> Excitation | None:
    if document is None:
        return None
    band = document.get("band_hz")
    return Excitation(**{**document, "band_hz": None if band is None else (band[0], band[1])})


def _dwell(document: dict[str, Any]) -> DwellSettings:
    windows = document.get("windows", DwellSettings().windows)
    settle = Settle(**document.get("settle", {}))
    return DwellSettings(windows, document.get("extend_to_windows", 4 * windows), settle)


def _check_consistent(plan: Plan) -> None:
    """Refuse what is fine alone and wrong together."""
    source = plan.source
    if bool(plan.passes) == (plan.excitation is not None):
        both = "both passes and excitation" if plan.passes else "neither passes nor excitation"
        raise source.error((), f"there are {both}; a plan has one of them")
    if len(plan.torque_nm) > 1 and not plan.ask_operator:
        message = "several torques need somebody to set them; add load: operator"
        raise source.error(("torque_nm",), message)
    _check_dwell(plan.dwell, source)
    if plan.excitation is not None:
        _check_excitation(plan.excitation, source)


def _check_dwell(dwell: DwellSettings, source: Source) -> None:
    needed = dwell.settle.min_windows + dwell.settle.over_windows
    if dwell.windows <= needed:
        message = (
            f"{dwell.windows} windows leave none to measure after settling "
            f"(min_windows + over_windows = {needed}); choose at least {needed + 1}"
        )
        raise source.error(("dwell", "windows"), message)
    if dwell.extend_to_windows < dwell.windows:
        message = f"{dwell.extend_to_windows} is below windows; choose at least {dwell.windows}"
        raise source.error(("dwell", "extend_to_windows"), message)


def _check_excitation(excitation: Excitation, source: Source) -> None:
    reach_deg = abs(excitation.centre_deg) + excitation.amplitude_deg
    if reach_deg > MAX_PHASE_DEG:
        message = (
            f"with centre {excitation.centre_deg:g} the phase reaches {reach_deg:g}, beyond "
            f"{MAX_PHASE_DEG:g}; choose at most {MAX_PHASE_DEG - abs(excitation.centre_deg):g}"
        )
        raise source.error(("excitation", "amplitude_deg"), message)
    alien = {"telegraph": ("period_s", "band_hz"), "multisine": ("levels", "switch_probability")}
    for key in alien[excitation.kind]:
        if key in source.document["excitation"]:
            message = f"means nothing for {excitation.kind}; remove it"
            raise source.error(("excitation", key), message)
    band = excitation.band_hz
    if band is not None and band[0] >= band[1]:
        message = f"{band[0]:g} is not below {band[1]:g}; write the lower frequency first"
        raise source.error(("excitation", "band_hz"), message)
