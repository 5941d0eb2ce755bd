// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/cupti.h"

#include <map>
#include <mutex>
#include <optional>

namespace tandem::cuda {

/// Times of GPU commands from CUPTI's activity records. CUPTI exists once per process, so one object serves
/// all devices and threads. The first start() loads its library.
/// CUPTI is attached to the driver only between the first start() and the last stop(). While attached, even
/// with nothing enabled, it makes each launch 0.5 us longer (H200, CUPTI 13.0). During the last stop() no
/// thread may be in a driver call.
class Activity {
public:
    /// Nanoseconds of CUPTI's clock.
    struct Span {
        std::int64_t begin = 0, end = 0;
    };

    /// Uses the first of these libraries that loads.
    explicit Activity(std::vector<std::string> names) : names_(std::move(names)) {}
    Activity(const Activity&) = delete;
    Activity& operator=(const Activity&) = delete;

    /// Starts recording; each successful start() needs one stop(). False when there is no CUPTI, when it
    /// refuses, as with another profiler attached, and when it has failed before.
    bool start();
    void stop();

    /// Begins a command: all driver calls of this thread until end_command(). Returns its id; 0 when it gets
    /// no record.
    std::uint64_t begin_command();
    void end_command(std::uint64_t id);
    /// Fetches the records of all completed commands.
    void collect();
    /// Returns and forgets the times of a command whose records are fetched; no value when a record is lost.
    std::optional<Span> take(std::uint64_t id);

    /// "CUPTI 13.0 activity records"; requires that start() has succeeded.
    std::string name() const;
    /// Why it is no longer usable; empty while it may be.
    std::string failure() const;
    void fail(std::string why);

private:
    /// The records of one driver call: its command, and its times.
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
    void add_span(std::uint32_t correlation, std::uint64_t start, std::uint64_t end);

    const std::vector<std::string> names_;
    std::mutex attaching_; ///< guards the next four; CUPTI's callbacks never lock it
    bool opened_ = false;
    std::unique_ptr<const Cupti> cupti_;
    CuptiSubscriber subscriber_ = nullptr; ///< while attached
    std::size_t users_ = 0;
    mutable std::mutex mutex_; ///< guards the rest; never held during a call of CUPTI
    std::string failure_;
    std::uint64_t last_id_ = 0;
    std::size_t outstanding_ = 0;                ///< commands not yet taken
    std::map<std::uint32_t, Gathered> gathered_; ///< by CUPTI's id of the call
    std::map<std::uint64_t, Span> spans_;        ///< by command
};

/// The only instance of this process, for a driver of that CUDA version (13000 is 13.0).
Activity& activity(int driver_version);

} // namespace tandem::cuda
