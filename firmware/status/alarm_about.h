// What an alarm is about, for programs: where a page goes from it.
#pragma once

#include "firmware/alarms/alarm.h"
#include "firmware/gateway/gateway.h"
#include "firmware/status/text_writer.h"

namespace etcm::firmware {

// Writes one of ,"about":{"node":7}, {"feature":3,"node":7} (the number of the feature as of now,
// and a node at an end, where one is), {"bus":"yard"}, {"bus":"yard","unit":7},
// {"gateway":"north"}; nothing for an alarm about the gateway itself, and for what is no longer in
// the settings. O(features), O(units) or O(readings).
void write_about(const Gateway& gateway, AlarmKey key, TextWriter& piece);

}  // namespace etcm::firmware
