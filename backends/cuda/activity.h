// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/cupti.h"

#include <map>
#include <mutex>
#include <optional>

namespace tandem::cuda {

/// When GPUs did what they were told to, by CUPTI's records of it. CUPTI is one for the process, and so is
/// this, for all devices and threads. Its library is opened at the first start(). It is attached to the
/// driver from the first start() to the last stop() only: attached, even with nothing enabled, it makes each
/// launch 0.5 us longer (H200, CUPTI 13.0). During that last stop() no thread may be in a call of the driver.
class Activity {
public:
    /// Nanoseconds of CUPTI's clock.
    struct Span {
        std::int64_t begin = 0, end = 0;
    };

    /// Of the first of these libraries that there is.
    explicit Activity(std::vector<std::string> names) : names_(std::move(names)) {}
    Activity(const Activity&) = delete;
    Activity& operator=(const Activity&) = delete;

    /// Records are made from here on, until as many calls of stop(). False where there is no CUPTI, where it
    /// refuses, as it does when another profiler is there, and where it has failed before.
    bool start();
    void stop();

    /// What this thread tells the driver until end_command() is one command: its id; 0 when it will have no
    /// record.
    std::uint64_t begin_command();
    void end_command(std::uint64_t id);
    /// Fetches the records of all that has run.
    void collect();
    /// When a command of whom records were fetched ran; unknown when one got lost. Forgets it.
    std::optional<Span> take(std::uint64_t id);

    /// "CUPTI 13.0 activity records", once it has been started.
    std::string name() const;
    /// Why it is of no use any more; empty while it may be.
    std::string failure() const;
    void fail(std::string why);

private:
    /// What is known of one call of the driver: which command made it, and when that ran.
    struct Gathered {
        std::uint64_t command = 0;
        std::optional<Span> span;
    };

    static void requested(unsigned char** buffer, std::size_t* bytes, std::size_t* most_records);
    static void completed(CUctx_st*, std::uint32_t, unsigned char* buffer, std::size_t, std::size_t valid);
    bool open();
    bool attach();
    void detach();
    bool done(CuptiResult code, std::string_view call);
    void gather(const CuptiRecord& record);
    void ran(std::uint32_t correlation, std::uint64_t start, std::uint64_t end);

    const std::vector<std::string> names_;
    std::mutex attaching_; ///< for the next four; never taken by what CUPTI calls
    bool opened_ = false;
    std::unique_ptr<const Cupti> cupti_;
    CuptiSubscriber subscriber_ = nullptr; ///< while attached
    std::size_t users_ = 0;
    mutable std::mutex mutex_; ///< for the rest; never held while CUPTI is called
    std::string failure_;
    std::uint64_t last_id_ = 0;
    std::size_t outstanding_ = 0;                ///< commands not yet taken
    std::map<std::uint32_t, Gathered> gathered_; ///< by CUPTI's number of the call
    std::map<std::uint64_t, Span> spans_;        ///< by command
};

/// That of this process, with a driver for that CUDA.
Activity& activity(int driver_version);

} // namespace tandem::cuda
