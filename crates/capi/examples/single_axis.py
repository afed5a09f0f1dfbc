"""One axis over a simulated drive, through ctypes: power on, there and back, power off. It is the program of single_axis.c,
and moves by the same bits; with a third argument it prints them.

    python3 single_axis.py LIBRARY INCLUDE [bits]
"""

import ctypes
import re
import struct
import sys
from pathlib import Path

TYPES = {
    "uint8_t": ctypes.c_uint8,
    "uint16_t": ctypes.c_uint16,
    "uint32_t": ctypes.c_uint32,
    "uint64_t": ctypes.c_uint64,
    "int16_t": ctypes.c_int16,
    "int32_t": ctypes.c_int32,
    "int64_t": ctypes.c_int64,
    "double": ctypes.c_double,
    "char": ctypes.c_char,
}


class Library:
    """The shared library and the structures of its headers, which are flat: what stands there is all there is to know."""

    def __init__(self, library: str, include: str) -> None:
        self.functions = ctypes.CDLL(library)
        texts = [(Path(include) / name).read_text() for name in ("standstill.h", "standstill_blocks.h")]
        text = re.sub(r"/\*.*?\*/", "", "\n".join(texts), flags=re.DOTALL)
        self.numbers = {name: int(value) for name, value in re.findall(r"#define STANDSTILL_(\w+) (\d+)\b", text)}
        self.bodies = dict(re.findall(r"typedef struct standstill_(\w+) \{(.*?)\}", text, re.DOTALL))
        self.sizes = {name: int(size) for name, size in re.findall(r"STANDSTILL_ASSERT\((\w+), .*? == (\d+)\)", text)}
        # The initial values that are not 0, as the inline functions of the header write them.
        self.initial = {
            name: re.findall(r"\w+\.(\w+) = ([-\d.e]+);", body)
            for name, body in re.findall(r"standstill_(\w+)_default\(void\) \{(.*?)\}", text, re.DOTALL)
        }
        self.classes: dict[str, type[ctypes.Structure]] = {}

    def new(self, name: str) -> ctypes.Structure:
        """A structure with its size, and of a block with the initial values of its pins."""
        made = self.of(name)()
        made.size = ctypes.sizeof(made)
        for field, value in self.initial.get(name, []):
            setattr(made, field, type(getattr(made, field))(float(value)))
        return made

    def of(self, name: str) -> type[ctypes.Structure]:
        """The class of a structure, laid out as in C."""
        if name not in self.classes:
            made = type(name, (ctypes.Structure,), {"_fields_": [self.field(line) for line in self.lines(name)]})
            assert ctypes.sizeof(made) == self.sizes.get(name, ctypes.sizeof(made)), f"{name} is laid out otherwise"
            self.classes[name] = made
        return self.classes[name]

    def lines(self, name: str) -> list[str]:
        return [line.strip() for line in self.bodies[name].split(";") if line.strip()]

    def field(self, line: str) -> tuple[str, type]:
        words, count = re.fullmatch(r"(.*?)(?:\[(\w+)\])?", line).groups()
        kind, field = words.rsplit(" ", 1)
        if field.startswith("*"):
            return field[1:], ctypes.c_void_p
        if count is None:
            return field, TYPES[kind]
        many = int(count) if count.isdigit() else self.numbers[count.removeprefix("STANDSTILL_")]
        return field, TYPES[kind] * many

    def call(self, function: str, *arguments: object) -> None:
        """Calls a function; structures and numbers to be written go by reference, and any result but OK is an exception."""
        by_reference = (ctypes.Structure, ctypes.c_uint64, ctypes.c_size_t, ctypes.c_int32)
        given = [ctypes.byref(one) if isinstance(one, by_reference) else one for one in arguments]
        result = getattr(self.functions, "standstill_" + function)(*given)
        if result != 0:
            words = self.functions.standstill_result_text
            words.restype = ctypes.c_char_p
            raise RuntimeError(f"{function}: {words(result).decode()}")


def bits(value: float) -> str:
    return struct.pack(">d", value).hex()


def main(library: str, include: str, *show: str) -> None:
    c = Library(library, include)
    config = c.new("runtime_config")
    config.axes, config.instances, config.cycle_ns = 1, 16, 1_000_000
    size = ctypes.c_size_t()
    c.call("runtime_size", config, size)
    # Aligned to 16 bytes, and kept as long as the runtime is.
    storage = ctypes.create_string_buffer(size.value + 16)
    start = -(-ctypes.addressof(storage) // 16) * 16
    runtime = ctypes.c_void_p()
    abi = ctypes.c_uint32(c.numbers["ABI_VERSION"])
    begin = (abi, ctypes.c_void_p(start), ctypes.c_size_t(size.value), ctypes.byref(config), ctypes.byref(runtime))
    assert c.functions.standstill_runtime_init(*begin) == 0

    setup, drive = c.new("axis_setup"), c.new("drive_setup")
    c.call("axis_defaults", setup)
    setup.velocity, setup.acceleration, setup.jerk, setup.snap = 50.0, 1000.0, 50_000.0, 5_000_000.0
    c.call("drive_defaults", drive)
    axis = ctypes.c_int32()
    c.call("axis_add", runtime, setup, drive, axis)

    # The program: instances are keys, 0 until they are first called.
    power_key, there_key, back_key = ctypes.c_uint64(), ctypes.c_uint64(), ctypes.c_uint64()
    power, powered = c.new("mc_power_in"), c.new("mc_power_out")
    there, gone = c.new("mc_move_absolute_in"), c.new("mc_move_absolute_out")
    back, come = c.new("mc_move_absolute_in"), c.new("mc_move_absolute_out")
    power.axis = there.axis = back.axis = axis.value
    there.position, there.velocity = 4.0, 50.0
    back.position, back.velocity = 0.0, 25.0

    status = c.new("axis_status")
    for scan in range(500):
        c.call("tick_begin", runtime, ctypes.c_int64(scan * 1_000_000))
        power.enable = scan < 450
        c.call("mc_power", runtime, power_key, power, powered)
        there.execute = powered.status
        c.call("mc_move_absolute", runtime, there_key, there, gone)
        back.execute = gone.done
        c.call("mc_move_absolute", runtime, back_key, back, come)
        c.call("tick_end", runtime)
        c.call("axis_read", runtime, axis.value, status)
        if show:
            numbers = " ".join(bits(value) for value in (status.position, status.velocity, status.acceleration))
            print(f"{numbers} {powered.status}{gone.done}{come.done}")
    assert (status.state, status.position) == (0, 0.0), f"state {status.state} at {status.position}"
    c.call("runtime_close", runtime)
    print("there and back, and off")


if __name__ == "__main__":
    main(*sys.argv[1:])
