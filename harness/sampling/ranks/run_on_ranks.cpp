// SPDX-License-Identifier: MIT
#include "harness/sampling/ranks/run_on_ranks.h"

#include "algorithms/distributed/agreement.h"
#include "harness/record/environment.h"
#include "harness/sampling/interrupt.h"
#include "harness/sampling/ranks/environment.h"
#include "harness/sampling/ranks/mpi_environment.h"
#include "harness/commands/standard_streams.h"

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

/// An error that is one rank's alone ends the job: the others may wait for this rank.
int end_job(Ranks& ranks, const std::exception& error) {
    print_message_from_every_rank("tandem: rank {}: {}; it ends the job\n", ranks.rank(), error.what());
    ranks.abort(3);
    return 3; // which g++ 12 misses behind a virtual function that does not return
}

/// All ranks run the command. What they print is the same, and the first one's counts.
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

/// The exit code of rank 0, once it has printed everything: a launcher may end all ranks once one has ended.
/// MPI waits by polling without a pause, which would take a core each.
int end_with_rank_0(Ranks& ranks, int code) {
    if (ranks.is_first()) {
        flush_output();
        for (int rank = 1; rank < ranks.size(); ++rank) ranks.send(rank, std::as_bytes(std::span(&code, 1)));
        return code;
    }
    const Interrupt interrupt; // rank 0 decides what a signal ends
    while (!ranks.is_there()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
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
    const int others = ranks->size() - 1;
    print_message("tandem: {} runs on one rank; the other {}\n", command,
                  others == 1 ? "waits" : fmt::format("{} wait", others));
}

void warn_tasks_are_no_ranks() {
    const int tasks = tasks_without_mpi();
    const char* number = std::getenv("SLURM_PROCID");
    if (tasks == 1 || number == nullptr || number != std::string_view("0")) return;
    print_message(
        "tandem: srun started {} tasks that know nothing of each other, and each measures everything; for "
        "ranks of one job give it --mpi=pmix, or another of srun --mpi=list\n",
        tasks);
}

} // namespace tandem
