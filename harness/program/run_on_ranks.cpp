// SPDX-License-Identifier: MIT
#include "harness/program/run_on_ranks.h"

#include "algorithms/distributed/agreement.h"
#include "harness/program/environment.h"
#include "harness/program/interrupt.h"
#include "harness/program/launcher.h"
#include "harness/program/mpi_environment.h"
#include "base/standard_streams.h"

#include <cstdlib>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <string_view>
#include <thread>

namespace tandem {

namespace {

using nlohmann::json;

/// Why the ranks cannot work together; empty when they can. The result is the same on all ranks.
std::string disagreement(Ranks& ranks, const std::vector<std::string>& words) {
    const auto own = json{{"sources", sources_digest()}, {"words", words}}.dump(
        -1, ' ', false, json::error_handler_t::replace);
    const auto all = ranks.gather_to_all(std::as_bytes(std::span(own)));
    const auto message_of = [&](std::size_t rank) {
        const auto* text = reinterpret_cast<const char*>(all[rank].data());
        return json::parse(text, text + all[rank].size());
    };
    const auto first = message_of(0);
    for (std::size_t rank = 1; rank < all.size(); ++rank) {
        const auto other = message_of(rank);
        if (other.at("sources") != first.at("sources"))
            return fmt::format(
                "rank {} runs a program built from other sources than rank 0 ({} and {}); install the same "
                "build on every machine",
                rank, other.at("sources").get<std::string>(), first.at("sources").get<std::string>());
        if (other.at("words") != first.at("words"))
            return fmt::format("rank {} has another command line than rank 0: {}; start all ranks with the "
                               "same command line",
                               rank, fmt::join(other.at("words").get<std::vector<std::string>>(), " "));
    }
    return {};
}

/// An error of a single rank ends the job, because the other ranks may wait for this rank.
int end_job(Ranks& ranks, const std::exception& error) {
    print_message_from_every_rank("tandem: rank {}: {}; this error ends the job\n", ranks.rank(),
                                  error.what());
    ranks.abort(3);
    return 3; // never reached; g++ 12 requires it after a virtual [[noreturn]] function
}

/// Runs the command on all ranks. All would print the same text, so that only rank 0 prints.
int run_on_all(Ranks& ranks, const ReadLine& read) {
    if (!ranks.is_first()) silence_streams();
    try {
        std::function<int()> act;
        run_together(ranks, [&] { act = read(); });
        return act();
    } catch (const std::exception& error) {
        if (dynamic_cast<const OfAllRanks*>(&error) != nullptr) throw;
        return end_job(ranks, error);
    }
}

/// Returns the exit code of rank 0 after it has printed everything, because a launcher may end all ranks once
/// one has ended. Waiting ranks sleep between polls; MPI's own wait would occupy a core for each.
int end_with_rank_0(Ranks& ranks, int code) {
    if (ranks.is_first()) {
        flush_output();
        for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, std::as_bytes(std::span(&code, 1)));
        return code;
    }
    const Interrupt interrupt; // rank 0 alone reacts to a signal
    while (!ranks.probe()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return MessageReader(ranks.receive().bytes).read<int>();
}

} // namespace

int run_on_ranks(Ranks& ranks, const std::vector<std::string>& words, const ReadLine& read,
                 const Guard& guard) {
    if (const auto why = disagreement(ranks, words); !why.empty()) {
        if (ranks.is_first()) print_message("tandem: {}\n", why);
        return 2;
    }
    const bool is_run = !words.empty() && words.front() == "run";
    int code = 0;
    if (is_run)
        code = guard([&] { return run_on_all(ranks, read); });
    else if (ranks.is_first())
        code = guard([&] { return read()(); });
    return end_with_rank_0(ranks, code);
}

void report_idle_ranks(const std::string& command) {
    const auto* ranks = job_ranks();
    if (ranks == nullptr) return;
    const int waiting = ranks->size() - 1;
    print_message("tandem: {} runs on one rank; the other {}\n", command,
                  waiting == 1 ? "waits" : fmt::format("{} wait", waiting));
}

void warn_tasks_are_no_ranks() {
    const int tasks = tasks_without_mpi();
    const char* number = std::getenv("SLURM_PROCID");
    if (tasks == 1 || number == nullptr || number != std::string_view("0")) return;
    print_message(
        "tandem: srun started {} independent tasks, and each measures everything; to make them ranks of one "
        "job, give srun --mpi=pmix or another type of srun --mpi=list\n",
        tasks);
}

} // namespace tandem
