"""Names in the run folder, as the contract has them."""

FORMAT = "usmbench-run/1"
RUN_FILE = "run.yaml"
WINDOWS_FILE = "windows.csv"
PAIRS_FILE = "pairs.csv"
RAW_FILE = "raw.h5"
DATA_FILES = (WINDOWS_FILE, PAIRS_FILE, RAW_FILE)

DRIVE_COLUMN = "drive_on"
WINDOW_COLUMNS = (
    "t_s",
    "phase_deg",
    "speed_rad_s",
    "frequency_hz",
    "torque_nm",
    "angle_rad",
    "window_s",
    "sweep",
    "settled",
    "average_rad_s",
    DRIVE_COLUMN,
)
TEMPERATURE_COLUMN = "temperature_c"
# With a temperature sensor on the bench.
WINDOW_COLUMNS_T = (*WINDOW_COLUMNS, TEMPERATURE_COLUMN)
PAIR_COLUMNS = (
    "phase_deg",
    "frequency_hz",
    "torque_nm",
    "speed_rad_s",
    "speed_std_rad_s",
    "n_windows",
    "direction",
    "t_s",
)
# What the writer adds, for --resume and for the reader of the pairs.
PAIR_COLUMNS_WRITTEN = (*PAIR_COLUMNS, "dwell", "settled")
