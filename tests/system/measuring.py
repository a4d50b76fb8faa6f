"""Tanks that pymodbus plays: surveyed devices whose level is register 3, in mm, 32767 where it is not
valid. What they measure is a file that a test writes anew."""
import json
import os
import pathlib
import sys

from programs import free_port

DEVICE = pathlib.Path(__file__).resolve().parents[1] / "profile" / "pymodbus_device.py"
INVALID = 32767

PROFILE = """
[[profile]]
name = "tank"
[[profile.reading]]
name = "level"
unit = "m"
value = { register = 3, type = "i16", scale = "0.001", none = 32767 }
[[profile.reading]]
name = "temperature"
unit = "°C"
value = { register = 4, type = "i16", scale = "0.1", none = 32767 }
"""


class Tanks:
    """`places` has (x, y) of unit 1, 2 and so on; the node of unit n has serial `first` + n."""

    def __init__(self, case, places, name="tanks", first=100):
        self.file = case.folder / f"{name}.json"
        self.port = free_port()
        self.levels = {}
        self.set({unit: INVALID for unit in range(1, len(places) + 1)})
        case.start(name, [sys.executable, DEVICE, self.port, self.file])
        self.settings = f"""
[[bus]]
tcp = "127.0.0.1:{self.port}"
name = "{name}"
[[bus.device]]
units = "1-{len(places)}"
profile = "tank"
timeout = "2s"
""" + "".join(f"""[[node]]
bus = "{name}"
unit = {unit}
serial = {first + unit}
x = {x}
y = {y}
""" for unit, (x, y) in enumerate(places, start=1))

    def set(self, levels):
        """In mm by unit; None is silence."""
        self.levels |= levels
        text = json.dumps({str(unit): {"3": {"3": level & 0xFFFF, "4": 215}}
                           for unit, level in self.levels.items() if level is not None})
        beside = self.file.with_suffix(".new")
        beside.write_text(text)
        os.replace(beside, self.file)
