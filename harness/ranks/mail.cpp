// SPDX-License-Identifier: MIT
#include "harness/ranks/mail.h"

#include <chrono>
#include <thread>

namespace tandem {

namespace {

/// File names in keys of scenes need not be UTF-8; JSON must be.
void send_json(Ranks& ranks, int to, const nlohmann::json& message) {
    const auto text = message.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    ranks.send(to, std::as_bytes(std::span(text)));
}

Post::Message received(Ranks& ranks) {
    const auto message = ranks.receive();
    const auto* text = reinterpret_cast<const char*>(message.bytes.data());
    return {message.from, nlohmann::json::parse(text, text + message.bytes.size())};
}

} // namespace

void pause_for_mail() { std::this_thread::sleep_for(std::chrono::milliseconds(10)); }

void RankMail::send(const nlohmann::json& message) { send_json(ranks_, 0, message); }

std::optional<nlohmann::json> RankMail::take() {
    if (!ranks_.is_there()) return std::nullopt;
    return received(ranks_).text;
}

void Letters::put(nlohmann::json message) {
    const std::lock_guard lock(mutex_);
    messages_.push_back(std::move(message));
}

std::optional<nlohmann::json> Letters::take() {
    const std::lock_guard lock(mutex_);
    if (messages_.empty()) return std::nullopt;
    auto message = std::move(messages_.front());
    messages_.pop_front();
    return message;
}

void Post::send(int to, const nlohmann::json& message) {
    if (to == 0)
        to_own_.put(message);
    else
        send_json(ranks_, to, message);
}

void Post::send_to_all(const nlohmann::json& message) {
    for (int rank = 0; rank < size(); ++rank) send(rank, message);
}

std::optional<Post::Message> Post::take() {
    if (auto own = from_own_.take()) return Message{0, std::move(*own)};
    if (!ranks_.is_there()) return std::nullopt;
    return received(ranks_);
}

} // namespace tandem
