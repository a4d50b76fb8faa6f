"""Position nodes served by pymodbus: a peer that shares no code with the gateway.

usage: pymodbus_nodes.py PORT SERIAL,X,Y...   (units 1, 2, ... in this order)
"""
import sys

from pymodbus.datastore import (ModbusSequentialDataBlock, ModbusServerContext,
                                ModbusSlaveContext)
from pymodbus.server import StartTcpServer


def words(value):
    return [value >> 16 & 0xFFFF, value & 0xFFFF]


def registers(serial, x, y):
    return [0x4554, 0x010C, *words(serial), 7, *words(x), *words(y), 1, 1, 7]


def main():
    units = {}
    for number, text in enumerate(sys.argv[2:], start=1):
        serial, x, y = map(int, text.split(","))
        block = ModbusSequentialDataBlock(0, registers(serial, x, y))
        units[number] = ModbusSlaveContext(ir=block, hr=block, zero_mode=True)
    StartTcpServer(context=ModbusServerContext(slaves=units, single=False),
                   address=("127.0.0.1", int(sys.argv[1])), ignore_missing_slaves=True,
                   allow_reuse_address=True)


main()
