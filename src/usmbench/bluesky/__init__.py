"""The bench as bluesky devices, and run folders as event-model documents.

Needs the extra ``usmbench[bluesky]``.
"""

from usmbench.bluesky.open import Devices, devices_of, open_devices

__all__ = ["Devices", "devices_of", "open_devices"]
