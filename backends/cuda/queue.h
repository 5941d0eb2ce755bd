// SPDX-License-Identifier: MIT
#pragma once

#include "backends/cuda/call_error.h"
#include "backends/cuda/command_clock.h"
#include "backends/cuda/current_context.h"
#include "backends/cuda/graphs.h"
#include "backends/staging.h"

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace tandem::cuda {

/// The stream of a device: enqueues commands or holds them back for a graph, times them and waits for them.
/// Every function may throw DeviceError.
class Queue {
public:
    /// Receives the number of driver calls that submitted the commands of an as_one().
    using Counter = std::function<void(std::uint64_t calls)>;

    /// Uses an application's `stream` of `context`, or makes a stream. `libraries`, `info` and the context
    /// must outlive it.
    Queue(const Libraries& libraries, const DeviceInfo& info, Context context, std::optional<Stream> stream,
          Counter counter);
    /// Waits.
    ~Queue();
    Queue(const Queue&) = delete;
    Queue& operator=(const Queue&) = delete;

    Stream stream() const { return stream_; }
    /// As Device::clock().
    std::string clock() const { return clock_ ? clock_->name() : expected_clock(driver()); }
    /// Page-locked memory for transfers; a wait releases it. Requires a Scope.
    Staging& staging() { return staging_; }
    /// The number of buffers freed so far; each buffer of the device increments it at its end.
    const std::shared_ptr<std::uint64_t>& frees() const { return frees_; }

    /// Throws the error of a driver call unless `result` is 0. Waits before, because the handler of the error
    /// may free memory that commands in flight still use. `what` is text or a callable that makes it, called
    /// on failure only.
    template<class What>
    void check(Result result, std::string_view call, const What& what) const {
        if (result == 0) return;
        if constexpr (std::is_invocable_v<What>)
            fail(result, call, what());
        else
            fail(result, call, what);
    }

    /// Makes the device's context current during an operation, and restores the caller's.
    class Scope {
    public:
        explicit Scope(const Queue& queue) : current_(queue.driver(), queue.context_) {
            queue.check(current_.result(), "cuCtxSetCurrent", "starting a command");
        }

    private:
        CurrentContext current_;
    };

    // These three require a Scope.

    /// Enqueues a command on `buffers`, or holds both back. Returns the ticket.
    std::uint64_t enqueue(const Command& command, std::span<Buffer::Impl* const> buffers);
    /// Enqueues a command after those held back, and waits for it. `staged`: its host memory is of staging(),
    /// so it has the same address in the next frame.
    std::uint64_t enqueue_and_wait(const Command& command, bool staged);
    /// Call it before an upload of `bytes` bytes. A large one, and all later commands, are not held back.
    void prepare_upload(std::size_t bytes);

    /// As Device::do_begin_collecting() and Device::do_end_collecting().
    bool begin_collecting();
    void end_collecting();

    /// Waits for all commands and collects their times.
    void finish();
    /// Later commands run after everything submitted so far to `stream`.
    void follow(Stream stream);
    /// What is submitted to `stream` later runs after everything submitted so far here.
    void precede(Stream stream);
    /// As Device::is_captured(). The default stream cannot be captured.
    bool is_captured() const;
    /// Switches the timing of commands on or off.
    void set_clocks(Clocks clocks);
    /// As Device::do_interval().
    std::pair<std::int64_t, std::int64_t> interval(std::uint64_t ticket);

private:
    const Driver& driver() const { return libraries_.driver; }
    void put_in_order(Stream first, Stream second);
    [[noreturn]] void fail(Result result, std::string_view call, std::string_view what) const;
    template<class What>
    void wait(const What& what);
    std::uint64_t enqueue_now(const Command& command);
    void submit_collected();
    /// Runs `submit`, timed when clocks are on. Returns the ticket.
    template<class Submit>
    std::uint64_t timed(const Submit& submit);

    const Libraries& libraries_;
    const DeviceInfo& info_;
    const Context context_;
    const bool owned_; ///< the stream is its own
    Stream stream_ = nullptr;
    EventHandle order_ = nullptr;         ///< in the last stream that was followed; null before
    std::unique_ptr<CommandClock> clock_; ///< null until clocks are on for the first time
    bool timed_ = false;
    Staging staging_;
    const Counter count_submissions_;
    bool in_one_ = false;                                ///< within as_one()
    bool collects_ = false;                              ///< within as_one(), and commands are held back
    std::vector<Command> collected_;                     ///< held back
    std::vector<std::shared_ptr<Buffer::Impl>> buffers_; ///< of these commands, to keep them alive
    Graphs graphs_;
    const std::shared_ptr<std::uint64_t> frees_ = std::make_shared<std::uint64_t>(0);
    std::uint64_t known_frees_ = 0; ///< frees_ when the graphs were last valid
};

} // namespace tandem::cuda
