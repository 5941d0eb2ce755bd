// SPDX-License-Identifier: MIT
#include "algorithms/distributed/agreement.h"

#include "backends/device.h"
#include "base/error.h"

#include <algorithm>
#include <fmt/format.h>

namespace tandem {

namespace {

enum class ErrorKind : std::uint32_t { none, input, output, memory, other };

struct Failure {
    ErrorKind kind = ErrorKind::none;
    std::string message{};
    bool operator==(const Failure&) const = default;
};

Failure failure_of(const std::function<void()>& work) {
    try {
        work();
    } catch (const InputError& error) {
        return {ErrorKind::input, error.what()};
    } catch (const OutputError& error) {
        return {ErrorKind::output, error.what()};
    } catch (const OutOfMemory& error) {
        return {ErrorKind::memory, error.what()};
    } catch (const std::bad_alloc&) {
        return {ErrorKind::other, "out of host memory; use fewer bodies or frames"};
    } catch (const std::exception& error) {
        return {ErrorKind::other, error.what()};
    }
    return {};
}

[[noreturn]] void throw_shared(const Failure& failure) {
    if (failure.kind == ErrorKind::input) throw SharedError<InputError>(failure.message);
    if (failure.kind == ErrorKind::output) throw SharedError<OutputError>(failure.message);
    if (failure.kind == ErrorKind::memory) throw SharedError<OutOfMemory>(failure.message);
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
        failure.kind = reader.read<ErrorKind>();
        failure.message = reader.read_text();
    }
    const auto first =
        std::ranges::find_if(all, [](const Failure& failure) { return failure.kind != ErrorKind::none; });
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
