// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <optional>

namespace tandem {

/// Messages to and from the first rank, as one that works for it sees them. May throw RanksError.
class Mail {
public:
    virtual ~Mail() = default;
    virtual void send(const nlohmann::json& message) = 0;
    /// The next one; none where none has come.
    virtual std::optional<nlohmann::json> take() = 0;
};

/// Between polls for messages. Waiting as MPI does would take a whole core from what is being measured.
void pause_for_mail();

/// Of another rank.
class RankMail final : public Mail {
public:
    explicit RankMail(Ranks& ranks) : ranks_(ranks) {}
    void send(const nlohmann::json& message) override;
    std::optional<nlohmann::json> take() override;

private:
    Ranks& ranks_;
};

/// Messages of one thread for another, in order.
class Letters {
public:
    void put(nlohmann::json message);
    std::optional<nlohmann::json> take();

private:
    std::mutex mutex_;
    std::deque<nlohmann::json> messages_;
};

/// Of the thread of the first rank that works as the others do.
class ThreadMail final : public Mail {
public:
    ThreadMail(Letters& out, Letters& in) : out_(out), in_(in) {}
    void send(const nlohmann::json& message) override { out_.put(message); }
    std::optional<nlohmann::json> take() override { return in_.take(); }

private:
    Letters& out_;
    Letters& in_;
};

/// The first rank's side: mail with every rank, its own thread being rank 0.
class Post {
public:
    explicit Post(Ranks& ranks) : ranks_(ranks) {}

    struct Message {
        int from = 0;
        nlohmann::json text;
    };
    int size() const { return ranks_.size(); }
    void send(int to, const nlohmann::json& message);
    void send_to_all(const nlohmann::json& message);
    /// The next one; none where none has come.
    std::optional<Message> take();
    /// The thread's side.
    ThreadMail own_mail() { return {from_own_, to_own_}; }

private:
    Ranks& ranks_;
    Letters to_own_, from_own_;
};

} // namespace tandem
