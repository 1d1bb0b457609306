"""Some tests need what `make -C firmware` builds; without it they are left out."""

from hil_sim.gpsim_bridge import BUILD

collect_ignore = (
    []
    if (BUILD / "bridge").is_file()
    else [
        "test_benchmarks.py",
        "test_bridge.py",
        "test_build.py",
    ]
)
