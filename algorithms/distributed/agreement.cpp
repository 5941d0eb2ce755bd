// SPDX-License-Identifier: MIT
#include "algorithms/distributed/agreement.h"

#include "backends/device.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

enum class Kind : std::uint32_t { none, input, output, memory, other };

struct Failure {
    Kind kind = Kind::none;
    std::string message{};
    bool operator==(const Failure&) const = default;
};

Failure failure_of(const std::function<void()>& work) {
    try {
        work();
    } catch (const InputError& error) {
        return {Kind::input, error.what()};
    } catch (const OutputError& error) {
        return {Kind::output, error.what()};
    } catch (const OutOfMemory& error) {
        return {Kind::memory, error.what()};
    } catch (const std::bad_alloc&) {
        return {Kind::other, "out of host memory; use fewer bodies or frames"};
    } catch (const std::exception& error) {
        return {Kind::other, error.what()};
    }
    return {};
}

[[noreturn]] void throw_shared(const Failure& failure) {
    if (failure.kind == Kind::input) throw SharedError<InputError>(failure.message);
    if (failure.kind == Kind::output) throw SharedError<OutputError>(failure.message);
    if (failure.kind == Kind::memory) throw SharedError<OutOfMemory>(failure.message);
    throw SharedError<DeviceError>(failure.message);
}

} // namespace

void run_together(Ranks& ranks, const std::function<void()>& work) {
    const auto own = failure_of(work);
    Ranks::Bytes message;
    append(message, std::span(&own.kind, 1));
    append_text(message, own.message);
    std::vector<Failure> all;
    for (const auto& bytes : ranks.gather_to_all(message)) {
        MessageReader reader(bytes);
        auto& failure = all.emplace_back();
        failure.kind = reader.read<Kind>();
        failure.message = reader.read_text();
    }
    const auto first =
        std::ranges::find_if(all, [](const Failure& failure) { return failure.kind != Kind::none; });
    if (first == all.end()) return;
    const bool is_same_on_all = std::ranges::count(all, *first) == std::ssize(all);
    if (!is_same_on_all) first->message = fmt::format("rank {}: {}", first - all.begin(), first->message);
    throw_shared(*first);
}

std::string of_rank_0(Ranks& ranks, const std::string& own) {
    auto message = as_message(std::span(own));
    ranks.broadcast(message, 0);
    return {reinterpret_cast<const char*>(message.data()), message.size()};
}

} // namespace tandem
