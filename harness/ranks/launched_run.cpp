// SPDX-License-Identifier: MIT
#include "harness/ranks/launched_run.h"

#include "harness/environment.h"
#include "harness/interrupt.h"
#include "harness/ranks/companions.h"
#include "harness/ranks/environment.h"
#include "harness/ranks/launched.h"
#include "harness/standard_streams.h"

#include <cstdlib>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

namespace tandem {

namespace {

using nlohmann::json;

/// Why the ranks cannot work together; empty when they can. All ranks come to the same.
std::string disagreement(Ranks& ranks, const std::vector<std::string>& words) {
    const auto own = json{{"sources", sources_digest()}, {"words", words}}.dump(
        -1, ' ', false, json::error_handler_t::replace);
    const auto all = ranks.gather_to_all(std::as_bytes(std::span(own)));
    const auto said = [&](std::size_t rank) {
        const auto* text = reinterpret_cast<const char*>(all[rank].data());
        return json::parse(text, text + all[rank].size());
    };
    const auto first = said(0);
    for (std::size_t rank = 1; rank < all.size(); ++rank) {
        const auto other = said(rank);
        if (other.at("sources") != first.at("sources"))
            return fmt::format(
                "rank {} is a program of other sources than rank 0 ({} and {}); give every machine the "
                "same build",
                rank, other.at("sources").get<std::string>(), first.at("sources").get<std::string>());
        if (other.at("words") != first.at("words"))
            return fmt::format("rank {} was given another line than rank 0: {}; give all the same", rank,
                               fmt::join(other.at("words").get<std::vector<std::string>>(), " "));
    }
    return {};
}

/// The others end with the first.
int lead(Ranks& ranks, const std::function<int()>& command) {
    const int code = command();
    flush_output(); // a launcher may end all ranks once one has ended
    const auto text = json{{"do", "end"}, {"code", code}}.dump();
    for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, std::as_bytes(std::span(text)));
    return code;
}

/// The next message of the first rank. MPI waits by polling without a pause, which takes a whole core from
/// what is being measured.
json next_message(Ranks& ranks) {
    while (!ranks.is_there()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const auto message = ranks.receive();
    const auto* text = reinterpret_cast<const char*>(message.bytes.data());
    return json::parse(text, text + message.bytes.size());
}

/// Does what the first rank asks for, until its command has ended; returns the command's exit code. A rank
/// that cannot go on ends the job.
int follow(Ranks& ranks) {
    try {
        const Interrupt interrupt; // the first rank decides what a signal ends
        for (;;) {
            const auto message = next_message(ranks);
            if (message.at("do") == "end") return message.at("code").get<int>();
            serve_companion(ranks);
        }
    } catch (const std::exception& error) {
        tell("tandem: rank {}: {}; it ends the job\n", ranks.rank(), error.what());
        ranks.abort(3);
        return 3; // which g++ 12 misses behind a virtual function that does not return
    }
}

} // namespace

int run_launched(Ranks& ranks, const std::vector<std::string>& words, const std::function<int()>& command) {
    if (const auto why = disagreement(ranks, words); !why.empty()) {
        if (ranks.is_first()) tell("tandem: {}\n", why);
        return 2;
    }
    return ranks.is_first() ? lead(ranks, command) : follow(ranks);
}

void tell_others_wait(const std::string& command) {
    const auto* ranks = launched_ranks();
    if (ranks == nullptr) return;
    const int others = ranks->size() - 1;
    tell("tandem: {} runs on one rank; the other {}\n", command,
         others == 1 ? "waits" : fmt::format("{} wait", others));
}

void tell_tasks_are_no_ranks() {
    const int tasks = tasks_without_mpi();
    const char* number = std::getenv("SLURM_PROCID");
    if (tasks == 1 || number == nullptr || number != std::string_view("0")) return;
    tell("tandem: srun started {} tasks that know nothing of each other, and each measures everything; for "
         "ranks of one job give it --mpi=pmix, or another of srun --mpi=list\n",
         tasks);
}

} // namespace tandem
