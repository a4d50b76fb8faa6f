"""Devices served by pymodbus, which have the registers that they are told of and no others.

usage: pymodbus_device.py ADDRESS UNITS
ADDRESS is a TCP port, "rtu:" and one for RTU frames over TCP, or the path of a serial port. UNITS is
JSON: {"5": {"3": {"200": 1}}} is holding register 200 (function 3) of unit 5; or the path of a file
with it, which is read again at each question: a unit that is in it no more is silent.
"""
import json
import pathlib
import sys

from pymodbus.datastore import ModbusServerContext, ModbusSlaveContext, ModbusSparseDataBlock
from pymodbus.exceptions import NoSuchSlaveException
from pymodbus.server import StartSerialServer, StartTcpServer
from pymodbus.transaction import ModbusRtuFramer


class FileBlock(ModbusSparseDataBlock):
    """The registers of a unit as a file has them now."""

    def __init__(self, path, unit, function):
        self.path, self.unit, self.function = path, unit, function
        super().__init__({65535: 0})

    def validate(self, address, count=1):
        units = json.loads(self.path.read_text())
        if self.unit not in units:
            raise NoSuchSlaveException(self.unit)
        registers = units[self.unit].get(self.function, {})
        self.values = {int(at): value for at, value in registers.items()}
        return all(at in self.values for at in range(address, address + count))


def block(registers):
    # One register at least, where nobody looks.
    return ModbusSparseDataBlock({int(at): value for at, value in registers.items()} or {65535: 0})


def main():
    address = sys.argv[1]
    if sys.argv[2].startswith("{"):
        units = json.loads(sys.argv[2])
        table = lambda unit, function: block(units[unit].get(function, {}))
    else:
        path = pathlib.Path(sys.argv[2])
        units = json.loads(path.read_text())
        table = lambda unit, function: FileBlock(path, unit, function)
    context = ModbusServerContext(single=False, slaves={
        int(unit): ModbusSlaveContext(hr=table(unit, "3"), ir=table(unit, "4"), zero_mode=True)
        for unit in units})
    if address.startswith("/"):
        StartSerialServer(context=context, framer=ModbusRtuFramer, port=address, baudrate=9600,
                          parity="N", stopbits=1, ignore_missing_slaves=True)
    elif address.startswith("rtu:"):
        StartTcpServer(context=context, framer=ModbusRtuFramer, ignore_missing_slaves=True,
                       address=("127.0.0.1", int(address[4:])), allow_reuse_address=True)
    else:
        StartTcpServer(context=context, address=("127.0.0.1", int(address)),
                       ignore_missing_slaves=True, allow_reuse_address=True)


main()
