#include "broker_model.h"

#include <algorithm>

namespace etcm::test {

using Session = BrokerModel::Session;

namespace {

constexpr std::size_t window = 20;
constexpr std::size_t history_max = 4;

}  // namespace

bool matches(std::string_view filter, std::string_view topic) {
  while (true) {
    if (filter == "#") return true;
    const std::size_t end = filter.find('/'), stop = topic.find('/');
    const std::string_view level = filter.substr(0, end), part = topic.substr(0, stop);
    if (level != "+" && level != part) return false;
    if (end == std::string_view::npos || stop == std::string_view::npos) {
      return end == stop || (stop == std::string_view::npos && filter.substr(end) == "/#");
    }
    filter.remove_prefix(end + 1);
    topic.remove_prefix(stop + 1);
  }
}

void BrokerModel::step(Instant now) {
  for (std::size_t i = 0; i < wills_.size();) {
    if (wills_[i].at > now) {
      ++i;
      continue;
    }
    const Due due = std::move(wills_[i]);
    wills_.erase(wills_.begin() + static_cast<std::ptrdiff_t>(i));
    take(due.side, due.message, false, now);
  }
  for (std::size_t side = 0; side < sides; ++side) {
    while (!bridge_[side].empty() && bridge_[side].front().at <= now) {
      const Due due = std::move(bridge_[side].front());
      bridge_[side].pop_front();
      take(side, due.message, true, now);
    }
  }
  // Sessions may not come or go meanwhile.
  for (std::size_t i = 0; i < sessions_.size(); ++i) {
    Session& session = *sessions_[i];
    while (!session.sent.empty() && session.sent.front().at <= now) {
      const Session::Sent sent = std::move(session.sent.front());
      session.sent.pop_front();
      take(session.side, sent.message, false, now);
      if (session.is_open) session.acknowledged.emplace(later(now), sent.token);
    }
  }
  std::erase_if(sessions_,
                [](const auto& session) { return !session->is_open && session->sent.empty(); });
}

Instant BrokerModel::next() const {
  Instant next = port::never;
  for (const Due& will : wills_) next = std::min(next, will.at);
  for (const auto& towards : bridge_) {
    if (!towards.empty()) next = std::min(next, towards.front().at);
  }
  for (const auto& session : sessions_) {
    if (!session->sent.empty()) next = std::min(next, session->sent.front().at);
    if (!session->is_open) continue;
    if (!session->acknowledged.empty()) next = std::min(next, session->acknowledged.begin()->first);
    for (const auto& [topic, queue] : session->incoming) {
      if (!queue.empty()) next = std::min(next, queue.front().at);
    }
  }
  return next;
}

void BrokerModel::take(std::size_t side, const ModelMessage& message, bool is_from_bridge,
                       Instant now) {
  if (message.is_retained) {
    if (message.payload.empty()) {
      retained_[side].erase(message.topic);
    } else {
      retained_[side][message.topic] = message.payload;
    }
  }
  for (const auto& session : sessions_) {
    const bool wants =
        session->is_open && session->side == side &&
        std::any_of(session->filters.begin(), session->filters.end(),
                    [&](const std::string& filter) { return matches(filter, message.topic); });
    if (wants) deliver(*session, message, false, now);
  }
  if (is_from_bridge || !is_bridged_) return;
  std::deque<Due>& towards = bridge_[1 - side];
  Instant at = later(now);
  if (!towards.empty()) at = std::max(at, towards.back().at);
  towards.push_back({.at = at, .side = 1 - side, .message = message});
}

void BrokerModel::deliver(Session& session, const ModelMessage& message, bool is_retained,
                          Instant now) {
  std::deque<Session::Incoming>& queue = session.incoming[message.topic];
  Instant at = later(now);
  if (!queue.empty()) at = std::max(at, queue.back().at);
  if (!habits_.reorders || message.is_in_order) {
    at = session.last_incoming = std::max(at, session.last_incoming);
  }
  const std::uint64_t number = message.is_in_order ? ++session.last_number : 0;
  queue.push_back({.message = message, .was_retained = is_retained, .at = at, .number = number});
  if (message.is_in_order) return;
  std::deque<ModelMessage>& history = session.history[message.topic];
  history.push_back(message);
  if (history.size() > history_max) history.pop_front();
}

void BrokerModel::redeliver(Instant now) {
  for (const auto& session : sessions_) {
    if (!session->is_open || random_.below(2) == 0) continue;
    for (const auto& [topic, history] : session->history) {
      if (random_.below(3) != 0) continue;
      const std::deque<ModelMessage> again = history;
      for (std::size_t i = random_.index(again.size()); i < again.size(); ++i) {
        std::deque<Session::Incoming>& queue = session->incoming[topic];
        Instant at = later(now);
        if (!queue.empty()) at = std::max(at, queue.back().at);
        queue.push_back({.message = again[i], .was_retained = false, .at = at, .number = 0});
      }
    }
  }
}

void BrokerModel::remember() { older_ = retained_; }

void BrokerModel::inject(std::size_t side, ModelMessage message, Instant now) {
  take(side, message, false, now);
}

void BrokerModel::restart(std::size_t side, Memory memory, Instant now) {
  for (const auto& session : sessions_) {
    if (session->side != side) continue;
    session->is_open = false;
    session->sent.clear();
  }
  std::erase_if(wills_, [side](const Due& due) { return due.side == side; });
  if (memory == Memory::none) retained_[side].clear();
  if (memory == Memory::older) retained_[side] = older_[side];
  if (memory == Memory::some) {
    std::erase_if(retained_[side], [&](const auto&) { return random_.below(2) == 0; });
  }
  // The bridge connects again too.
  if (is_bridged_) set_bridge(true, now);
}

void BrokerModel::set_bridge(bool is_up, Instant now) {
  is_bridged_ = is_up;
  if (!is_up) {
    for (auto& towards : bridge_) towards.clear();
    return;
  }
  for (std::size_t side = 0; side < sides; ++side) {
    for (const auto& [topic, payload] : retained_[1 - side]) {
      std::deque<Due>& towards = bridge_[side];
      Instant at = later(now);
      if (!towards.empty()) at = std::max(at, towards.back().at);
      towards.push_back({.at = at,
                         .side = side,
                         .message = {.topic = topic, .payload = payload, .is_retained = true}});
    }
  }
}

std::shared_ptr<Session> BrokerModel::connect(std::size_t side, const std::string& name,
                                              const std::vector<std::string>& filters,
                                              const ModelMessage& will, Instant now) {
  if (!name.empty()) take_over(name, now);
  const auto session = std::make_shared<Session>();
  session->side = side;
  session->name = name;
  session->filters = filters;
  session->will = will;
  sessions_.push_back(session);
  for (const auto& [topic, payload] : retained_[side]) {
    const bool wants =
        std::any_of(filters.begin(), filters.end(),
                    [&topic = topic](const std::string& filter) { return matches(filter, topic); });
    if (wants) {
      deliver(*session, {.topic = topic, .payload = payload, .is_retained = true}, true, now);
    }
  }
  return session;
}

// Of what the earlier one of this name has sent, nothing is taken any more.
void BrokerModel::take_over(const std::string& name, Instant now) {
  for (const auto& session : sessions_) {
    if (session->name == name) session->sent.clear();
  }
  for (Due& due : wills_) {
    if (due.name == name) due.at = now;
  }
  step(now);
}

void BrokerModel::send(Session& session, ModelMessage message, std::uint32_t token, Instant now) {
  session.last_sent = std::max(session.last_sent, later(now));
  session.sent.push_back({.message = std::move(message), .token = token, .at = session.last_sent});
}

void BrokerModel::end(Session& session, bool is_noticed_at_once, Instant now) {
  if (!session.is_open) return;
  session.is_open = false;
  // Of what is under way some gets through, from the front.
  const std::size_t through = random_.index(session.sent.size() + 1);
  session.sent.resize(through);
  session.incoming.clear();
  const auto most = static_cast<std::uint64_t>(habits_.notice_max.count());
  Instant at = is_noticed_at_once
                   ? now
                   : now + port::Duration(static_cast<std::int64_t>(random_.below(most + 1)));
  if (!session.sent.empty()) at = std::max(at, session.sent.back().at);
  if (!session.will.topic.empty()) {
    wills_.push_back(
        {.at = at, .side = session.side, .message = session.will, .name = session.name});
  }
}

void ModelClient::close(bool is_noticed_at_once, Instant now) {
  if (session_ != nullptr) broker_.end(*session_, is_noticed_at_once, std::max(now, now_));
}

void ModelClient::set_last_will(const port::BrokerMessage& message) {
  will_ = {.topic = std::string(message.topic),
           .payload = std::string(message.payload),
           .is_retained = message.retained,
           .is_in_order = !name_.empty()};
}

void ModelClient::subscribe(std::span<const std::string> filters) {
  filters_.insert(filters_.end(), filters.begin(), filters.end());
}

bool ModelClient::publish(const port::BrokerMessage& message, std::uint32_t token) {
  if (!is_connected() || session_->sent.size() + session_->acknowledged.size() >= window) {
    return false;
  }
  if (life_ == 0) return true;
  --life_;
  broker_.send(*session_,
               {.topic = std::string(message.topic),
                .payload = std::string(message.payload),
                .is_retained = message.retained,
                .is_in_order = !name_.empty() && message.at_most_once},
               token, now_);
  return true;
}

void ModelClient::connect_if_due(Instant now) {
  if (is_connected() || !has_network_ || now < retry_at_) return;
  session_ = broker_.connect(side_, name_, filters_, will_, now);
  is_told_ = true;
  ++counters_.connections;
  listener_->on_connected(clock_.at(now));
}

void ModelClient::take_incoming(Instant now) {
  while (is_connected()) {
    // Of the topics that have something, any.
    std::vector<std::deque<Session::Incoming>*> ready;
    std::erase_if(session_->incoming, [](const auto& entry) { return entry.second.empty(); });
    for (auto& [topic, queue] : session_->incoming) {
      const Session::Incoming& first = queue.front();
      const bool has_turn = first.number == 0 || first.number == session_->heard_number + 1;
      if (first.at <= now && has_turn) ready.push_back(&queue);
    }
    if (ready.empty()) return;
    for (std::deque<Session::Incoming>* const queue : ready) {
      const Session::Incoming next = std::move(queue->front());
      queue->pop_front();
      if (next.number != 0) session_->heard_number = next.number;
      listener_->on_message({.topic = next.message.topic,
                             .payload = next.message.payload,
                             .retained = next.was_retained},
                            clock_.at(now));
    }
  }
}

void ModelClient::step(Instant now) {
  now_ = now;
  if (session_ != nullptr && (!has_network_ || !session_->is_open)) {
    broker_.end(*session_, random_.below(2) == 0, now);
    session_ = nullptr;
    retry_at_ = now + std::chrono::milliseconds(200 * (1 + random_.below(10)));
    if (std::exchange(is_told_, false)) {
      listener_->on_disconnected("the connection is lost", clock_.at(now));
    }
  }
  connect_if_due(now);
  if (!is_connected()) return;
  auto& acknowledged = session_->acknowledged;
  while (!acknowledged.empty() && acknowledged.begin()->first <= now) {
    const std::uint32_t token = acknowledged.begin()->second;
    acknowledged.erase(acknowledged.begin());
    listener_->on_delivered(token, clock_.at(now));
  }
  take_incoming(now);
}

}  // namespace etcm::test
