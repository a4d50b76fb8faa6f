"""A device served by pymodbus, which has the registers it is told of and no others.

usage: pymodbus_device.py ADDRESS UNITS
ADDRESS is a TCP port, "rtu:" and one for RTU frames over TCP, or the path of a serial port; UNITS is JSON: {"5": {"3": {"200": 1}}} is
holding register 200 (function 3) of unit 5.
"""
import json
import sys

from pymodbus.datastore import ModbusServerContext, ModbusSlaveContext, ModbusSparseDataBlock
from pymodbus.server import StartSerialServer, StartTcpServer
from pymodbus.transaction import ModbusRtuFramer


def block(registers):
    # One register at least, where nobody looks.
    return ModbusSparseDataBlock({int(at): value for at, value in registers.items()} or {65535: 0})


def main():
    address, units = sys.argv[1], json.loads(sys.argv[2])
    context = ModbusServerContext(single=False, slaves={
        int(unit): ModbusSlaveContext(hr=block(tables.get("3", {})), ir=block(tables.get("4", {})),
                                      zero_mode=True)
        for unit, tables in units.items()})
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
