// SPDX-License-Identifier: MIT
#include "harness/ranks/sweep.h"

#include "harness/environment.h"
#include "harness/inputs.h"
#include "harness/interrupt.h"
#include "harness/isolation/request.h"
#include "harness/ranks/hand_message.h"
#include "harness/ranks/mail.h"
#include "harness/ranks/model_table.h"
#include "harness/ranks/swept_groups.h"
#include "harness/ranks/worker.h"
#include "harness/standard_streams.h"
#include "scenes/error.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <random>
#include <thread>

namespace tandem {

namespace {

using nlohmann::json;
using Clock = std::chrono::steady_clock;

/// The first rank's thread that works as the other ranks do.
class OwnWorker {
public:
    explicit OwnWorker(Post& post)
        : post_(post), thread_([&post] {
              auto mail = post.own_mail();
              obey(mail);
          }) {}
    ~OwnWorker() {
        post_.send(0, {{"do", "end"}, {"code", 0}});
        thread_.join();
    }
    OwnWorker(const OwnWorker&) = delete;
    OwnWorker& operator=(const OwnWorker&) = delete;

private:
    Post& post_;
    std::thread thread_;
};

/// What every rank has; waits for all of them.
Roster call_roll(Post& post, const std::vector<std::string>& names) {
    post.send_to_all({{"do", "describe"}, {"devices", names}});
    std::vector<Member> members(static_cast<std::size_t>(post.size()));
    for (int left = post.size(); left > 0;) {
        const auto message = post.take();
        if (!message) {
            pause_for_mail();
            continue;
        }
        members[static_cast<std::size_t>(message->from)] = member_of(message->text);
        --left;
    }
    return Roster(std::move(members));
}

/// Those that a sweep cannot do.
void refuse_of_one_process(const RunOptions& options) {
    const auto refuse_if = [](bool given, const char* option) {
        if (given)
            throw InputError(fmt::format("{} is of one process; leave the launcher of MPI out", option));
    };
    refuse_if(!options.dump_pairs.empty(), "--dump-pairs");
    refuse_if(!options.dump_contacts.empty(), "--dump-contacts");
    refuse_if(!options.trace.empty(), "--trace");
    refuse_if(options.profile > 0, "--profile");
}

/// A run of a plan over ranks.
class Sweep {
public:
    Sweep(const RunOptions& options, Ranks& ranks);
    int go();

private:
    void check_required() const;
    void open_groups();
    int list();
    void add_hands(std::size_t group);
    void deal();
    void deal_to(int rank, Hand hand);
    void handle(const Post::Message& message);
    void end_cell(int rank, const json& message);
    void end_hand(int rank, const json& message);
    void refuse_hand(int rank, const json& message);
    void give_up_undealable();
    void close_hand(std::size_t group);
    void stop();
    void run_until_all_ended();
    int end();

    const RunOptions& options_;
    Ranks& ranks_;
    Post post_;
    OwnWorker own_;
    Roster roster_;
    Dealer dealer_{roster_};
    CellGroups all_;
    std::optional<RecordFile> file_;
    FinishedCells finished_;
    Unfinished unfinished_;
    std::vector<SweptGroup> groups_;
    std::vector<std::optional<Hand>> held_; ///< [rank], what it measures
    std::uint64_t seed_;
    std::size_t printed_ = 0, measured_ = 0, cells_ = 0, left_out_ = 0;
    int code_ = 0;
    bool interrupted_ = false;
    std::optional<Clock::time_point> stopped_; ///< when the ranks were told to
    Progress progress_;
};

Sweep::Sweep(const RunOptions& options, Ranks& ranks)
    : options_(options),
      ranks_(ranks),
      post_(ranks),
      own_(post_),
      roster_(call_roll(post_,
                        [&] {
                            auto names = devices_of(plan_of(options));
                            names.insert(names.end(), options.require.begin(), options.require.end());
                            return names;
                        }())),
      held_(static_cast<std::size_t>(ranks.size())),
      seed_(options.seed ? *options.seed : std::random_device{}()),
      progress_(options.quiet) {
    check_required();
    all_ = make_groups(plan_of(options), [&](const auto& names) { return roster_.choose(names); });
    for (const auto& note : roster_.notes()) tell("tandem: {}\n", note);
    tell_left_out(all_);
}

/// One rank that has it suffices.
void Sweep::check_required() const {
    for (const auto& wanted : options_.require)
        if (std::ranges::none_of(roster_.members(),
                                 [&](const Member& member) { return is_there(wanted, member.backends); }))
            throw InputError(fmt::format("--require {}: no rank has it", wanted));
}

/// A mistake in the last scene had better be known before the first is measured, and leave no files behind.
void Sweep::open_groups() {
    if (!options_.dry_run)
        for (const auto& group : all_.groups) open_group(options_, group, {}, unfinished_);
    file_.emplace(options_.dry_run && !options_.resume ? std::string() : options_.out);
    if (options_.resume) finished_ = FinishedCells(*file_, options_.out);
    if (!options_.dry_run) unfinished_ = Unfinished(options_.out, options_.resume);
    for (const auto& group : all_.groups) {
        groups_.push_back(open_group(options_, group, finished_, unfinished_));
        cells_ += groups_.back().cells.size();
        left_out_ += groups_.back().left_out;
    }
}

int Sweep::list() {
    put_text(roster_.text());
    std::size_t number = 0;
    double seconds = 0;
    for (const auto& group : groups_) seconds += list_group(group, roster_, number);
    put("{} cells, about {:.0f} s of rounds of all ranks together{}; checks against the reference and the "
        "truth come on "
        "top\n",
        number, seconds,
        left_out_ > 0 ? fmt::format("; {} more are in {} already", left_out_, options_.out) : "");
    return 0;
}

void Sweep::add_hands(std::size_t group) {
    for (auto& hand : hands_of(group, groups_[group].cells, options_.deal_cells)) {
        dealer_.add(std::move(hand));
        ++groups_[group].open_hands;
    }
}

void Sweep::deal() {
    for (int rank = 0; rank < post_.size(); ++rank) {
        auto& held = held_[static_cast<std::size_t>(rank)];
        if (held) continue;
        if (auto hand = dealer_.next(rank)) deal_to(rank, std::move(*hand));
    }
}

void Sweep::deal_to(int rank, Hand hand) {
    auto& group = groups_[hand.group];
    const auto devices = roster_.devices_of(rank, hand.models);
    std::vector<DealtCell> dealt;
    for (const auto index : hand.cells) {
        auto& cell = group.cells[index];
        cell.devices = devices;
        for (auto& candidate : cell.candidates) candidate.devices = devices;
        group.ranks[index] = rank;
        dealt.push_back(
            {cell, cell.candidates.empty() ? unfinished_.state(cell, group.keys[index]) : CellState()});
    }
    post_.send(rank, hand_json(group.options, seed_, group.digest, devices, dealt));
    held_[static_cast<std::size_t>(rank)] = std::move(hand);
}

void Sweep::handle(const Post::Message& message) {
    const auto what = message.text.at("is").get<std::string>();
    if (what == "kept") unfinished_.keep(message.text.at("key").get<std::string>(), message.text.at("line"));
    if (what == "ended") end_cell(message.from, message.text);
    if (what == "done") end_hand(message.from, message.text);
    if (what == "refused") refuse_hand(message.from, message.text);
    if (what == "chosen") {
        const auto& hand = *held_[static_cast<std::size_t>(message.from)];
        auto& cell = groups_[hand.group].cells[hand.cells[message.text.at("cell").get<std::size_t>()]];
        cell = cell_of(message.text.at("as"), cell.devices);
    }
}

/// The record is the rank's but for what this process alone knows.
void Sweep::end_cell(int rank, const json& message) {
    const auto& hand = *held_[static_cast<std::size_t>(rank)];
    auto& group = groups_[hand.group];
    const auto index = hand.cells[message.at("cell").get<std::size_t>()];
    auto result = ended_result(message, group.cells[index]);
    auto record = nlohmann::ordered_json::parse(message.at("record").get<std::string>());
    record["session"] = session_id();
    record["command"] = without_folders(command_line());
    record["rank"] = {{"number", rank}, {"of", post_.size()}};
    progress_.clear();
    if (!file_->append_or_tell(record)) result.code = 3;
    if (!result.measured)
        tell("tandem: {} (rank {}): {}\n", describe(group.cells[index]), rank,
             message.at("failure").get<std::string>());
    code_ = std::max(code_, result.code);
    group.results[index] = std::move(result);
    progress_.show(
        fmt::format("[{}/{}] rank {}: {}", ++measured_, cells_, rank, describe(group.cells[index])));
}

void Sweep::close_hand(std::size_t group) {
    --groups_[group].open_hands;
    progress_.clear();
    for (; printed_ < groups_.size() && groups_[printed_].open_hands == 0; ++printed_)
        print_group(groups_[printed_]);
}

void Sweep::end_hand(int rank, const json& message) {
    auto& held = held_[static_cast<std::size_t>(rank)];
    if (message.at("interrupted").get<bool>()) {
        if (!stopped_) tell("tandem: rank {} was asked to end; other ranks go on\n", rank);
        interrupted_ = true;
        dealer_.leave_out(rank);
    }
    close_hand(held->group);
    held.reset();
}

/// Another rank may be able to.
void Sweep::refuse_hand(int rank, const json& message) {
    auto& held = held_[static_cast<std::size_t>(rank)];
    held->refused_by.insert(rank);
    held->refusal = message.at("why").get<std::string>();
    progress_.clear();
    tell("tandem: rank {} cannot measure {}: {}\n", rank, groups_[held->group].options.scene, held->refusal);
    code_ = std::max(code_, message.at("code").get<int>());
    dealer_.add(std::move(*held));
    held.reset();
}

void Sweep::give_up_undealable() {
    for (const auto& hand : dealer_.take_undealable()) {
        tell("tandem: {} cell{} of {} {} not measured: no rank is left that can\n", hand.cells.size(),
             hand.cells.size() == 1 ? "" : "s", groups_[hand.group].options.scene,
             hand.cells.size() == 1 ? "is" : "are");
        close_hand(hand.group);
    }
}

void Sweep::stop() {
    post_.send_to_all({{"do", "stop"}});
    stopped_ = Clock::now();
    interrupted_ = Interrupt::asked();
}

/// Ranks that were told to stop kill their processes and answer at once.
void Sweep::run_until_all_ended() {
    constexpr std::chrono::seconds patience{8};
    const auto is_busy = [&] {
        return std::ranges::any_of(held_, [](const auto& hand) { return hand.has_value(); });
    };
    for (;;) {
        if (!stopped_ && (Interrupt::asked() || file_->failed())) stop();
        if (!stopped_) {
            deal();
            give_up_undealable();
        }
        if (!is_busy() && (stopped_ || dealer_.is_empty())) return;
        if (stopped_ && Clock::now() - *stopped_ > patience) {
            tell("tandem: a rank does not stop; the records before are whole\n");
            ranks_.abort(3);
        }
        if (const auto message = post_.take())
            handle(*message);
        else
            pause_for_mail();
    }
}

/// What is said last.
int Sweep::end() {
    for (; printed_ < groups_.size(); ++printed_) print_group(groups_[printed_]);
    put_text(model_tables(groups_));
    if (left_out_ > 0) put("{} cells are in {} already\n", left_out_, options_.out);
    if (!options_.out.empty()) put("{} records appended to {}\n", file_->appended(), options_.out);
    const bool all_ended = std::ranges::all_of(groups_, [](const auto& group) {
        return std::ranges::all_of(group.results, [](const auto& r) { return r.has_value(); });
    });
    if (all_ended && !interrupted_ && !file_->failed()) unfinished_.remove();
    if (!interrupted_ || file_->failed()) return code_;
    tell("tandem: interrupted; {} cells are measured{}\n", measured_,
         options_.out.empty() ? ""
                              : fmt::format("; to go on, under the launcher: {}{}", command_line(),
                                            options_.resume ? "" : " --resume"));
    return 3;
}

int Sweep::go() {
    open_groups();
    if (options_.dry_run) return list();
    put_text(roster_.text());
    for (std::size_t group = 0; group < groups_.size(); ++group) add_hands(group);
    run_until_all_ended();
    return end();
}

} // namespace

int sweep_command(const RunOptions& options, Ranks& ranks) {
    refuse_of_one_process(options);
    const Interrupt interrupt;
    return Sweep(options, ranks).go();
}

} // namespace tandem
