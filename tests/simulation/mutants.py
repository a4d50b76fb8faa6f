#!/usr/bin/env python3
"""Plants faults into the gateway's sources, one at a time: the simulation must find each.

Usage: mutants.py NINJA BUILD SOURCE WORK [NAME...]

Compiles the changed source alone, as BUILD does it, and links it before the libraries that have the
sound one. A mutant whose text is not there any more is a mistake: then it is written anew.
"""

import os
import re
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

DAYS = os.environ.get("ETCM_SIMULATION_DAYS", "60")
# Those that want a rare meeting of faults begin at a life that has one.
FIRST_OF = {"a_frame_in_the_middle_of_an_answer_is_one": "190045063",
            "a_position_that_jumps_counts": "157", "a_standstill_is_a_cost": "1239",
            "one_that_was_replaced_is_left_behind": "300013", "what_the_broker_has_counts_in_any_plane": "160008005",
            "one_who_will_not_take_a_unit_is_never_asked_again": "67", "others_may_hold_a_bus": "37",
            "silence_counts_while_a_converter_is_held_up": "50009075",
            "units_are_given_where_somebody_answers": "31"}
# Only one life in hundreds meets these, another one after each change of the order in which units are asked. They
# are tried where they are named: ETCM_SIMULATION_DAYS in the environment is for how long.
RARE = {"a_sweep_goes_on_after_any_time", "all_newcomers_take_what_is_meant_for_one",
        "numbers_that_are_owed_are_used_again", "what_found_no_room_counts_as_told",
        "who_has_booted_is_not_told_again"}

# Name: the file, a text that stands in it once, what stands there instead.
MUTANTS = {
    # On the line.
    "answers_without_checksum": (
        "port/modbus/rtu_frame.cpp", "return rtu_checksum(bytes) == 0;", "return true;"),
    "late_answers_are_owed_no_more": (
        "port/modbus/owed_answers.cpp", "if (const Owed* const owed = find(question)) return owed->until;",
        "if (find(question) != nullptr) return {};"),
    "a_frame_in_the_middle_of_an_answer_is_one": (
        "port/modbus/rtu_bus.cpp", "if (phase_ == Phase::waiting && is_within_answer(*found)) return;", ""),
    "a_cut_line_is_not_opened_again": (
        "port/modbus/rtu_bus.cpp", "next_attempt_ = now + options_.reopen_interval;",
        "next_attempt_ = never;"),
    # Behind a converter.
    "answers_of_any_transaction": (
        "port/modbus/transaction_queue.cpp",
        "const auto found = std::find_if(entries_.begin(), entries_.end(),\n"
        "                                  [&](const Entry& entry) { return entry.owes(transaction); });",
        "const auto found = std::find_if(entries_.begin(), entries_.end(),\n"
        "                                  [&](const Entry& entry) { return entry.state < State::answered; });"),
    "numbers_that_are_owed_are_used_again": (
        "port/modbus/tcp_bus.cpp", "} while (queue_.is_owed(last_transaction_));", "} while (false);"),
    # What an answer is worth.
    "torn_registers_count": (
        "firmware/protocol/node_registers.cpp",
        "if (registers[at_sequence_before] != registers[at_sequence_after]) return ReadingFault::torn;", ""),
    "another_node_at_a_unit_is_not_seen": (
        "firmware/nodes/admission.cpp", "if (conflict.sightings < sightings_wanted) return nullptr;",
        "return nullptr;"),
    # Where the site has another plane.
    "one_that_was_replaced_is_left_behind": (
        "firmware/gateway/plane_change.cpp", "if (!is_device(asked, node.last_unit)) continue;",
        "if (!is_device(asked, node.is_missing ? node.last_unit : node.unit_index)) continue;"),
    "what_the_broker_has_counts_in_any_plane": (
        "firmware/gateway/fleet_link.cpp", "if (!writes_back_ && !is_moved_) place", "if (!writes_back_) place"),
    "devices_stay_where_they_were_in_another_plane": (
        "firmware/gateway/plane_change.cpp", "      node.position = *place;\n", ""),
    "what_was_saved_in_another_plane_is_taken_as_it_is": (
        "firmware/gateway/plane_change.cpp", "if (!saved.plane || *saved.plane == plane_of(to)) return false;",
        "return false;"),
    # Nodes that have no unit yet.
    "units_are_given_where_somebody_answers": (
        "firmware/nodes/address_assigner.cpp", "if ((port::is_absence(answer) || is_as_silent) && is_free(job.unit_index)) {\n        job.step",
        "if (true) {\n        job.step"),
    "silence_counts_while_a_converter_is_held_up": (
        "firmware/nodes/address_assigner.cpp", "const bool is_repeated = job.step == Step::look && job.silences > 0;",
        "const bool is_repeated = false;"),
    "newcomers_who_talk_at_once_get_no_unit": (
        "firmware/nodes/address_assigner.cpp", "++job.tries < unit_looks_max", "false"),
    "one_who_will_not_take_a_unit_is_never_asked_again": (
        "firmware/nodes/address_assigner.cpp", "if (job.last_serial == serial && now < job.retry_at) return;",
        "if (job.last_serial == serial) return;"),
    # Of a device that is read in blocks.
    "a_sweep_goes_on_after_any_time": (
        "firmware/polling/poller.cpp",
        "if (units_[unit.value].swept_at + sweep_pause_max < now) units_[unit.value].block = 0;", ""),
    "a_position_that_jumps_counts": (
        "firmware/polling/jump_check.cpp", "if (jumps && !agrees) {", "if (jumps && !agrees && !last_) {"),
    # Whether a position is in time, and how old it may be.
    "a_late_answer_becomes_a_position": (
        "port/modbus/rtu_bus.cpp", "  unit.owed.add(request_.question, sent_at_, until);\n", ""),
    "answers_are_waited_for_too_long": (
        "port/modbus/rtu_bus.cpp", "deadline_ = sent_at_ + timeout + silence_ +",
        "deadline_ = sent_at_ + 4 * timeout + silence_ +"),
    "sound_units_are_asked_seldom": (
        "firmware/polling/bus_schedule.cpp", "const port::Instant asked_by = now + poll_.interval;",
        "poll_.interval *= 3; const port::Instant asked_by = now + poll_.interval;"),
    "a_converter_is_asked_ever_more": (
        "port/modbus/transaction_queue.cpp",
        "return entry.head_at == never ? never : entry.head_at + patience(entry.request);",
        "return entry.request.sent_at + entry.request.timeout;"),
    # The mesh itself.
    "a_refused_call_corrupts_the_mesh": (
        "lib/src/conforming/transaction.cpp",
        "  m.work.go_back();\n  change.dirty.clear(m);\n  drop_fresh(change);",
        "  m.work.go_back();\n  change.dirty.clear(m);"),
    "all_leave_and_one_returns": (
        "lib/src/analysis/coverage.cpp",
        "if (d == nullptr || d->topology.triangle_count() == 0 || is_flat(*d)) {",
        "if (d == nullptr || is_flat(*d)) {"),
    # The disk.
    "the_copy_before_the_last_is_not_used": (
        "firmware/persist/state_saver.cpp", "{port::Copy::last, port::Copy::previous}", "{port::Copy::last}"),
    # When somebody edits the settings.
    "settings_with_mistakes_are_taken": (
        "firmware/config/reload.cpp", "  if (!mistakes.empty()) {\n    tell(", "  if (false) {\n    tell("),
    "nobody_is_told_of_a_refusal": (
        "firmware/config/reload.cpp", "  refusal = refusal_of(mistakes);", "  refusal.clear();"),
    "what_has_to_wait_is_taken_over": (
        "firmware/config/bus_reload.cpp", "if (!reload.must_wait()) return reload.take_over();",
        "return reload.take_over();"),
    "a_bus_that_is_added_is_not_asked": (
        "firmware/gateway/gateway.cpp",
        "for (const PolledBus& bus : added) poller_.add_bus(poll, bus);", ""),
    "features_of_before_stay": (
        "firmware/config/reload.cpp", "  settings.features = next.features;\n", ""),
    # Time.
    "a_standstill_is_a_cost": (
        "firmware/polling/bus_schedule.cpp",
        "return std::min(now - asked_at, cost_max_ + bus_.delay_max()) + answer.silence;",
        "return now - asked_at + answer.silence;"),
    "absent_units_are_forgotten": (
        "firmware/polling/bus_schedule.cpp",
        "ask_again(address, is_at_once ? unit.due : due);",
        "if (unit.failures < 6) ask_again(address, is_at_once ? unit.due : due);"),
    "a_dead_bus_lets_its_nodes_go": (
        "firmware/nodes/silence_clock.cpp",
        "return clock.shown - std::max(heard, clock.counts_from);",
        "return listened_ - std::max(heard, clock.counts_from);"),
    # What is known and what is shown.
    "a_move_is_not_followed": (
        "firmware/gateway/gateway.cpp",
        "if ((reading.status & node_status::fix_valid) != 0) follow_position(*node);",
        "if ((reading.status & node_status::fix_valid) != 0 && !node->is_placed()) follow_position(*node);"),
    "a_change_is_not_published": (
        "firmware/gateway/gateway.cpp", "changed_ = kept_.take_changed() || changed_;",
        "static_cast<void>(kept_.take_changed());"),
    "missing_nodes_stay_in_the_mesh": (
        "firmware/nodes/presence.cpp", 'placement_.leave(node, "silent", generation);', "return;"),
    # Over a restart.
    "generations_begin_anew": (
        "firmware/gateway/gateway.cpp", "generation_ = saved->next_generation - 1;",
        "generation_ = saved->generation;"),
    "restored_positions_are_fresh": (
        "firmware/persist/state_transfer.cpp",
        "record->positioned_at = saved_at - std::chrono::milliseconds(node.age_ms);\n  record->stale = true;",
        "record->positioned_at = now;"),
    # Others who have to do with it.
    "others_may_hold_a_bus": (
        "firmware/polling/bus_schedule.cpp",
        "return is_idle ? port::Instant{} : client_share_.free_at();", "return {};"),
    "others_are_not_told_of_a_lost_link": (
        "firmware/polling/client_requests.cpp",
        "case port::BusResult::link_lost:\n      return clients_->refuse(port::ClientRefusal::no_path);",
        "case port::BusResult::link_lost:\n      return;"),
    "older_words_of_another_gateway_count": (
        "firmware/fleet/fleet_record.cpp", "record.incarnation, record.sequence, ", "record.incarnation, "),
    "nodes_of_other_gateways_stay": (
        "firmware/gateway/fleet_link.cpp",
        "if (node == nullptr || !node->is_foreign() || !is_shared_) return;", "return;"),
    "a_new_broker_is_told_of_no_entities": (
        "firmware/home_assistant/announcer.cpp", "session_ == broker_.counters().connections && ", ""),
    "all_newcomers_take_what_is_meant_for_one": (
        "firmware/publish/neighbour_distributor.cpp", " || shares_unit(node.unit_index)", ""),
    "who_has_booted_is_not_told_again": (
        "firmware/publish/neighbour_distributor.cpp",
        "if (told.serial != node.serial || told.boot_count != node.boot_count) {",
        "if (told.serial != node.serial) {"),
    "a_new_host_is_not_born_for": (
        "firmware/sparkplug/edge_node.cpp",
        "  wants_births_ = true;\n  if (!is_birth_) is_under_way_ = false;", ""),
    "births_go_on_counting": (
        "firmware/sparkplug/edge_node.cpp", "    sequence_ = 0;\n", ""),
    "the_dead_are_not_told": (
        "firmware/sparkplug/edge_node.cpp", "(!is_there || node.serial != device.serial)",
        "(node.is_known() && node.serial != device.serial)"),
    "what_found_no_room_counts_as_told": (
        "firmware/sparkplug/edge_node.cpp", "  if (!add_changes(metrics, told)) return Outcome::nothing;\n",
        "  if (!add_changes(metrics, told)) return Outcome::nothing;\n  keep_told(metrics, told);\n"),
    "registers_change_while_they_are_read": (
        "firmware/publish/image_pool.cpp", "image.use_count() == 1", "image.use_count() <= 2"),
    "the_watchdog_starves": (
        "firmware/gateway/board_io.cpp", "watchdog_due_ = now + watchdog_interval;",
        "watchdog_due_ = now + 2 * watchdog_interval;"),
    "the_lamp_hides_that_there_is_no_node": (
        "firmware/gateway/board_io.cpp", "  if (node_count == 0) return 5;\n", "  static_cast<void>(node_count);\n"),
    "who_is_missing_is_not_told": (
        "firmware/alarms/alarm_watch.cpp", "if (is_with_its_gateway(gateway, node)) return;", "return;"),
    "an_alarm_never_ends": ("firmware/alarms/alarm_book.cpp", "  slot.alarm.is_on = false;\n", ""),
    "alarms_are_forgotten_at_a_restart": (
        "firmware/alarms/alarm_keeper.cpp", "book_ = std::move(read);", "static_cast<void>(read);"),
    "alarms_of_before_never_end": (
        "firmware/alarms/alarm_judging.cpp",
        "  if (now - from > 2 * sources_.gateway.settings().poll.leave_after + 1min) return true;\n"
        "  return is_judged_by_what_came(key, now);", "  return key.kind == AlarmKind{} && now < from;"),
}


class Build:
    def __init__(self, ninja, build, source, work):
        self.build, self.source, self.work = Path(build), Path(source), Path(work)
        said = subprocess.run([ninja, "-C", build, "-t", "commands", "simulation_test"],
                              capture_output=True, text=True, check=True).stdout.splitlines()
        self.commands = said
        self.link = next(line for line in reversed(said) if "-o tests/bin/simulation_test" in line)

    def run(self, command):
        return subprocess.run(command, shell=True, cwd=self.build, capture_output=True, text=True)

    def make(self, name):
        """The program with the mutant in it."""
        file, text, instead = MUTANTS[name]
        source = (self.source / file).read_text()
        if source.count(text) != 1:
            sys.exit(f"mutants: {name}: {file} has its text {source.count(text)} times; write it anew")
        folder = self.work / name
        folder.mkdir(parents=True, exist_ok=True)
        changed, made, program = folder / Path(file).name, folder / "mutant.o", folder / "simulation_test"
        changed.write_text(source.replace(text, instead))
        compiles = [line for line in self.commands if line.endswith(f"-c {self.source / file}")]
        if len(compiles) != 1:
            sys.exit(f"mutants: {file} is not compiled alone here")
        command = re.sub(r"-o \S+", f"-o {made}", compiles[0].replace(f"-c {self.source / file}", f"-c {changed}"))
        command = re.sub(r"-MF \S+", f"-MF {made}.d", command) + f" -Wno-error -iquote {(self.source / file).parent}"
        result = self.run(command)
        if result.returncode != 0:
            sys.exit(f"mutants: {name} does not compile:\n{result.stderr}")
        link = self.link.replace("-o tests/bin/simulation_test", f"-o {program} {made}")
        result = self.run(link)
        if result.returncode != 0:
            sys.exit(f"mutants: {name} does not link:\n{result.stderr}")
        return program

    def judge(self, name):
        """What the simulation says of it, or None: it has found nothing."""
        program = self.make(name)
        environment = dict(os.environ, ETCM_SIMULATION_DAYS=DAYS, ETCM_SIMULATION_WRONG="1",
                           ETCM_SIMULATION_FIRST=FIRST_OF.get(name, "1"))
        result = subprocess.run([program, "--gtest_filter=*AllOfIt"], env=environment, capture_output=True, text=True)
        program.unlink()
        if result.returncode == 0:
            return None
        found = re.search(r"^seed \d+, .*", result.stdout, re.M)
        return found.group(0) if found else f"it ended with {result.returncode}"


def main():
    ninja, build, source, work, *names = sys.argv[1:]
    made = Build(ninja, build, source, work)
    survivors = []
    started = time.monotonic()
    names = names or [name for name in MUTANTS if name not in RARE]
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        for name, found in zip(names, pool.map(made.judge, names)):
            print(f"{name}: {found or 'NOT FOUND'}", flush=True)
            if found is None:
                survivors.append(name)
    print(f"{len(names) - len(survivors)} of {len(names)} found, in {time.monotonic() - started:.0f} s")
    sys.exit(1 if survivors else 0)


if __name__ == "__main__":
    main()
