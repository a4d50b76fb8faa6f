"""What is changed, and which tests must find it: the quick ones first."""

from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


@dataclass(frozen=True)
class Group:
    files: list
    tests: list


def sources(folder, *names):
    """Those of the names, or all, in one order."""
    found = sorted(path for path in (ROOT / folder).iterdir() if path.suffix in (".cpp", ".h"))
    return [path.relative_to(ROOT).as_posix() for path in found if not names or path.stem in names]


GROUPS = {
    "predicates": Group(
        sources("lib/src/geometry", "predicates", "predicates_inline", "predicates_internal", "narrow_filter",
                "wide_int"),
        ["predicates_test", "feasible_parameter_test", "mesh_test", "hardest_work_test"]),
    "conforming": Group(
        [*sources("lib/src/conforming"), "lib/src/mesh/canonicalize.cpp"],
        ["dependence_test", "influence_test", "surroundings_test", "feasible_parameter_test", "dry_run_test",
         "keep_alive_test", "policy_test", "canonical_test", "hardest_work_test", "optimise_test", "capacity_test",
         "bound_test", "etcm-fuzz --canonical --first 484 --lives 10", "mesh_test", "order_test", "etcm-fuzz --lives 40",
         "history_test", "core_program", "work_test --gtest_filter=WorkOfARefused*"]),
    "framing": Group(
        sources("port/modbus", "frame", "rtu_frame", "rtu_bus", "rtu_line", "rtu_serial_line", "rtu_tcp_line",
                "owed_answers"),
        ["port_test --gtest_filter=*Rtu*:*Serial*:*Frame*:*Request*:*Answer*:*Pdu*:*Line*:*Libmodbus*:OwedAnswers.*",
         "firmware_test --gtest_filter=LateAnswers.*:BusSilence.*:*LineTime*:*BusyLine*:LostAnswers.*"]),
    "admission": Group(
        sources("firmware/nodes", "admission"),
        ["firmware_test --gtest_filter=Joining.*:NodesBySerial.*:Gateway.*:*Missing*:OneSite.*:Reload.*:"
         "WithoutAFix.*:Names*.*:StatusPageTest.*",
         "log_and_state_test --gtest_filter=Restart.*",
         "fleet_gateway_test --gtest_filter=*OneSerial*:Wanderers.*:FleetGateway.*"]),
}
