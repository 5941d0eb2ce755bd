// SPDX-License-Identifier: MIT
#include "backends/cuda/queue.h"

namespace tandem::cuda {

namespace {

/// Largest upload that is held back for a graph. A larger one and all later commands are submitted at once:
/// it takes about as long as the host needs for the rest of a frame's commands.
constexpr std::size_t max_held_back = std::size_t{64} << 10;

/// Page-locked memory for uploads in flight; uploads beyond it wait.
constexpr std::size_t max_staged = std::size_t{256} << 20;

/// The context must be current when the source is used.
Staging::Source page_locked(const Driver& driver) {
    const auto allocate = [&driver](std::size_t bytes) -> std::byte* {
        void* memory = nullptr;
        return driver.cuMemHostAlloc(&memory, bytes, 0) == 0 ? static_cast<std::byte*>(memory) : nullptr;
    };
    return {allocate, [&driver](std::byte* memory) { driver.cuMemFreeHost(memory); }};
}

} // namespace

Queue::Queue(const Libraries& libraries, const DeviceInfo& info, Context context,
             std::optional<Stream> stream, Counter counter)
    : libraries_(libraries),
      info_(info),
      context_(context),
      owned_(!stream),
      staging_(page_locked(libraries.driver), max_staged),
      count_submissions_(std::move(counter)),
      graphs_(libraries.driver) {
    if (stream) {
        stream_ = *stream;
        return;
    }
    const Scope scope(*this);
    constexpr unsigned non_blocking = 1; // CU_STREAM_NON_BLOCKING: no ordering with the default stream
    check(driver().cuStreamCreate(&stream_, non_blocking), "cuStreamCreate", "opening the device");
}

Queue::~Queue() {
    const CurrentContext current(driver(), context_);
    driver().cuStreamSynchronize(stream_);
    graphs_.drop();
    staging_.drop();
    clock_.reset();
    if (order_ != nullptr) driver().cuEventDestroy_v2(order_);
    if (owned_) driver().cuStreamDestroy_v2(stream_);
}

void Queue::fail(Result result, std::string_view call, std::string_view what) const {
    if (stream_ != nullptr || !owned_) {
        const CurrentContext current(driver(), context_);
        driver().cuStreamSynchronize(stream_);
    }
    throw_call_error(libraries_, info_, result, call, what);
}

template<class Submit>
std::uint64_t Queue::timed(const Submit& submit) {
    if (!timed_) {
        submit();
        return 0;
    }
    const auto check_clock = [&](CommandClock::Refusal refusal) {
        check(refusal.code, refusal.call, "timing a command");
    };
    check_clock(clock_->begin());
    try {
        submit();
        check_clock(clock_->end());
    } catch (...) {
        clock_->drop();
        throw;
    }
    return clock_->ticket();
}

template<class What>
void Queue::wait(const What& what) {
    submit_collected();
    check(driver().cuStreamSynchronize(stream_), "cuStreamSynchronize", what);
    staging_.release();
}

std::uint64_t Queue::enqueue_now(const Command& command) {
    return timed([&] {
        check(command.submit(driver(), stream_), command.call(), [&] { return command.describe(); });
    });
}

std::uint64_t Queue::enqueue(const Command& command, std::span<Buffer::Impl* const> buffers) {
    if (!collects_) {
        if (in_one_) count_submissions_(1);
        return enqueue_now(command);
    }
    collected_.push_back(command);
    for (auto* buffer : buffers) buffers_.push_back(buffer->shared_from_this());
    return 0;
}

std::uint64_t Queue::enqueue_and_wait(const Command& command, bool staged) {
    std::uint64_t ticket = 0;
    if (collects_ && !staged) {
        submit_collected();
        ticket = enqueue_now(command);
        count_submissions_(1);
    } else {
        ticket = enqueue(command, {});
    }
    wait([&] { return command.describe(); });
    return ticket;
}

void Queue::prepare_upload(std::size_t bytes) {
    if (!collects_ || bytes <= max_held_back) return;
    submit_collected();
    collects_ = false;
}

/// The default stream cannot be captured, and a stream that an application captures not a second time.
bool Queue::begin_collecting() {
    in_one_ = collects_ = stream_ != nullptr && !is_captured();
    return in_one_;
}

void Queue::end_collecting() {
    in_one_ = collects_ = false;
    submit_collected();
}

void Queue::submit_collected() {
    if (collected_.empty()) return;
    const Scope scope(*this);
    // An address may be reused for other memory, so graphs that use it become invalid.
    if (std::exchange(known_frees_, *frees_) != *frees_) {
        check(driver().cuStreamSynchronize(stream_), "cuStreamSynchronize",
              "waiting before graphs are destroyed");
        graphs_.drop();
    }
    std::uint64_t submissions = 0;
    const auto failure = graphs_.submit(collected_, stream_, submissions);
    count_submissions_(submissions);
    collected_.clear();
    if (failure.code != 0) {
        const auto buffers = std::exchange(buffers_, {}); // kept alive until check() has waited
        check(failure.code, failure.call, failure.what);
    }
    buffers_.clear();
}

void Queue::finish() {
    const Scope scope(*this);
    wait("waiting");
    if (timed_) clock_->collect();
}

/// Later commands of stream `second` run after everything submitted so far to stream `first`.
void Queue::put_in_order(Stream first, Stream second) {
    if (first == second) return;
    const Scope scope(*this);
    constexpr unsigned untimed = 2; // CU_EVENT_DISABLE_TIMING
    constexpr std::string_view what = "ordering two streams";
    if (order_ == nullptr) check(driver().cuEventCreate(&order_, untimed), "cuEventCreate", what);
    check(driver().cuEventRecord(order_, first), "cuEventRecord", what);
    check(driver().cuStreamWaitEvent(second, order_, 0), "cuStreamWaitEvent", what);
}

void Queue::follow(Stream stream) { put_in_order(stream, stream_); }

void Queue::precede(Stream stream) { put_in_order(stream_, stream); }

bool Queue::is_captured() const {
    if (stream_ == nullptr) return false;
    const Scope scope(*this);
    int status = 0;
    check(driver().cuStreamIsCapturing(stream_, &status), "cuStreamIsCapturing", "starting a frame");
    return status != 0;
}

void Queue::set_clocks(Clocks clocks) {
    const Scope scope(*this);
    if (timed_) clock_->stop();
    timed_ = clocks == Clocks::on;
    if (timed_) clock_ = started_clock(std::move(clock_), driver(), stream_);
}

std::pair<std::int64_t, std::int64_t> Queue::interval(std::uint64_t ticket) {
    const Scope scope(*this);
    const auto interval = clock_->interval(ticket);
    if (clock_->spent()) clock_ = started_clock(std::move(clock_), driver(), stream_);
    return interval;
}

} // namespace tandem::cuda
