// SPDX-License-Identifier: MIT
#include "harness/ranks/worker.h"

#include "harness/interrupt.h"
#include "harness/isolation/isolated_sampler.h"
#include "harness/isolation/request.h"
#include "harness/job.h"
#include "harness/ranks/hand_message.h"
#include "harness/ranks/roster.h"
#include "harness/run_parts.h"
#include "scenes/error.h"

#include <fmt/format.h>
#include <new>

namespace tandem {

namespace {

using nlohmann::json;

/// One rank at work.
class Worker {
public:
    Worker(Mail& mail, const std::function<void()>& share) : mail_(mail), share_(share) {}
    int obey();

private:
    void do_hand(const json& message);
    void measure(DealtHand& hand);
    void choose(std::vector<Cell>& cells, const RunOptions& options);
    bool is_stopped();

    Mail& mail_;
    const std::function<void()>& share_;
    std::optional<int> end_; ///< the exit code, once it is told
    bool stopped_ = false;
    AnsweringProcess process_; ///< which measures
};

/// Keeps what becomes of the cells of a hand with the first rank.
class MailKeeper final : public CellKeeper {
public:
    MailKeeper(Mail& mail, const std::vector<Cell>& cells, std::vector<DealtCell>& dealt)
        : mail_(mail), cells_(cells), dealt_(dealt) {}

    CellState state(const Cell& cell, const std::string&) override {
        return std::move(dealt_[index(cell)].state);
    }
    void keep(const CellSampler& sampler, const std::string& key, bool whole) override {
        mail_.send({{"is", "kept"}, {"key", key}, {"line", unfinished_json(sampler.state(), whole)}});
    }
    bool end(const CellResult& result, const nlohmann::ordered_json& record,
             const std::string& failure) override {
        auto message = ended_json(result, record, failure);
        message["cell"] = index(*result.cell);
        mail_.send(message);
        return true;
    }
    bool failed() const override { return false; }

private:
    std::size_t index(const Cell& cell) const { return static_cast<std::size_t>(&cell - cells_.data()); }

    Mail& mail_;
    const std::vector<Cell>& cells_;
    std::vector<DealtCell>& dealt_;
};

/// Messages that come meanwhile are to stop, or to end.
bool Worker::is_stopped() {
    while (const auto message = mail_.take()) {
        stopped_ = true;
        if (message->at("do") == "end") end_ = message->at("code").get<int>();
    }
    return stopped_ || Interrupt::asked();
}

/// Decides the cells of auto, each in a process of its own. One that cannot be decided stays its first
/// candidate, whose measurement will say why.
void Worker::choose(std::vector<Cell>& cells, const RunOptions& options) {
    for (std::size_t i = 0; i < cells.size(); ++i) {
        if (cells[i].candidates.empty()) continue;
        try {
            const auto answer = process_.ask(choosing_json(options, cells[i]),
                                             {options.timeout, [&] { return is_stopped(); }});
            cells[i] = cell_of(answer.at("cell"), cells[i].devices);
        } catch (const DeviceError&) {
            cells[i].candidates.clear();
        }
        mail_.send({{"is", "chosen"}, {"cell", i}, {"as", cell_json(cells[i])}});
    }
}

void Worker::measure(DealtHand& hand) {
    std::vector<Cell> planned;
    for (const auto& dealt : hand.cells) planned.push_back(dealt.cell);
    choose(planned, hand.options);
    const auto job = open_job(hand.options, std::move(planned));
    if (job.scene.digest != hand.digest)
        throw InputError(
            fmt::format("{}: is another scene here than on the first rank: digest {:016x} instead of "
                        "{:016x}; give all machines the same files",
                        job.scene.key, job.scene.digest, hand.digest));
    auto measuring = measuring_of(hand.options);
    measuring.stop = measuring.give_up = [&] { return is_stopped(); };
    measuring.process = &process_;
    References references(job.scene, job.range, checks_folder(hand.options));
    MailKeeper keeper(mail_, job.cells, hand.cells);
    const bool interrupted = measure_cells(job, job.cells, references, measuring, keeper, Progress(true),
                                           [](const CellResult&) {});
    mail_.send({{"is", "done"}, {"interrupted", interrupted}});
}

void Worker::do_hand(const json& message) {
    stopped_ = false;
    const auto refuse = [&](const std::string& why, int code) {
        mail_.send({{"is", "refused"}, {"why", why}, {"code", code}});
    };
    try {
        DealtHand hand(message);
        measure(hand);
    } catch (const GivenUp&) {
        mail_.send({{"is", "done"}, {"interrupted", true}});
    } catch (const InputError& error) {
        refuse(error.what(), 2);
    } catch (const RanksError&) {
        throw;
    } catch (const std::bad_alloc&) {
        refuse("out of host memory; use fewer bodies or frames", 3);
    } catch (const std::exception& error) {
        refuse(error.what(), 3);
    }
}

int Worker::obey() {
    while (!end_) {
        const auto message = mail_.take();
        if (!message) {
            pause_for_mail();
            continue;
        }
        const auto what = message->at("do").get<std::string>();
        if (what == "end") end_ = message->at("code").get<int>();
        if (what == "hand") do_hand(*message);
        if (what == "share") share_();
        if (what == "describe") {
            auto answer = member_json(message->at("devices").get<std::vector<std::string>>());
            answer["is"] = "described";
            mail_.send(answer);
        }
    }
    return *end_;
}

} // namespace

int obey(Mail& mail, const std::function<void()>& share) { return Worker(mail, share).obey(); }

} // namespace tandem
