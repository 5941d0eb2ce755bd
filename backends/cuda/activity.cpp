// SPDX-License-Identifier: MIT
#include "backends/cuda/activity.h"

#include "backends/device.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <fmt/format.h>
#include <new>

namespace tandem::cuda {

namespace {

constexpr std::array gathered_kinds{cupti_kernel, cupti_memcpy, cupti_memset, cupti_driver,
                                    cupti_external_correlation};

/// Enough for about three thousand commands.
constexpr std::size_t bytes_of_records = std::size_t{1} << 20;

/// The object that CUPTI's callbacks use; they have no pointer to user data.
std::atomic<Activity*> attached = nullptr;

Activity::Span merged(const std::optional<Activity::Span>& before, Activity::Span more) {
    if (!before) return more;
    return {std::min(before->begin, more.begin), std::max(before->end, more.end)};
}

} // namespace

std::string Activity::name() const { return fmt::format("CUPTI {} activity records", cupti_->version); }

std::string Activity::failure() const {
    const std::lock_guard lock(mutex_);
    return failure_;
}

void Activity::fail(std::string why) {
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) failure_ = std::move(why);
}

bool Activity::done(CuptiResult code, std::string_view call) {
    if (code != 0) fail(fmt::format("{} failed with {}", call, code));
    return code == 0;
}

bool Activity::open() {
    if (!std::exchange(opened_, true)) {
        try {
            cupti_ = open_cupti(names_);
        } catch (const DeviceError& error) {
            fail(error.what());
        }
    }
    return cupti_ != nullptr && failure().empty();
}

bool Activity::start() {
    const std::lock_guard lock(attaching_);
    if (!open() || (users_ == 0 && !attach())) return false;
    ++users_;
    return true;
}

void Activity::stop() {
    const std::lock_guard lock(attaching_);
    if (--users_ == 0) detach();
}

/// CUPTI allows one subscriber. Subscribing keeps our records apart from those of other profilers.
bool Activity::attach() {
    const auto ignore = [](void*, int, std::uint32_t, const void*) {};
    if (!done(cupti_->cuptiSubscribe(&subscriber_, ignore, nullptr), "cuptiSubscribe")) {
        subscriber_ = nullptr;
        return false;
    }
    attached = this;
    const auto enable = [&](CuptiKind kind) {
        return done(cupti_->cuptiActivityEnable(kind), "cuptiActivityEnable");
    };
    if (done(cupti_->cuptiActivityRegisterCallbacks(requested, completed), "cuptiActivityRegisterCallbacks")
        && std::all_of(gathered_kinds.begin(), gathered_kinds.end(), enable))
        return true;
    detach();
    return false;
}

void Activity::detach() {
    done(cupti_->cuptiActivityFlushAll(0), "cuptiActivityFlushAll");
    for (const auto kind : gathered_kinds) cupti_->cuptiActivityDisable(kind);
    cupti_->cuptiUnsubscribe(std::exchange(subscriber_, nullptr));
    done(cupti_->cuptiFinalize(), "cuptiFinalize");
    const std::lock_guard lock(mutex_);
    gathered_.clear();
    spans_.clear();
}

std::uint64_t Activity::begin_command() {
    std::uint64_t id = 0;
    {
        const std::lock_guard lock(mutex_);
        if (!failure_.empty()) return 0;
        id = ++last_id_;
        ++outstanding_;
    }
    if (done(cupti_->cuptiActivityPushExternalCorrelationId(cupti_custom, id),
             "cuptiActivityPushExternalCorrelationId"))
        return id;
    take(id);
    return 0;
}

void Activity::end_command(std::uint64_t id) {
    if (id != 0)
        done(cupti_->cuptiActivityPopExternalCorrelationId(cupti_custom, nullptr),
             "cuptiActivityPopExternalCorrelationId");
}

void Activity::requested(unsigned char** buffer, std::size_t* bytes, std::size_t* most_records) {
    *buffer = new (std::nothrow) unsigned char[bytes_of_records]; // null: the records are lost
    *bytes = *buffer != nullptr ? bytes_of_records : 0;
    *most_records = 0; // as many as fit
}

void Activity::completed(CUctx_st*, std::uint32_t, unsigned char* buffer, std::size_t, std::size_t valid) {
    const std::unique_ptr<unsigned char[]> owned(buffer);
    auto& self = *attached.load();
    const std::lock_guard lock(self.mutex_);
    CuptiRecord* record = nullptr;
    while (self.cupti_->cuptiActivityGetNextRecord(buffer, valid, &record) == 0) self.gather(*record);
}

void Activity::gather(const CuptiRecord& record) {
    if (record.kind == cupti_external_correlation) {
        const auto& known = reinterpret_cast<const CuptiCorrelation&>(record);
        if (known.whose == cupti_custom) gathered_[known.correlation].command = known.id;
    } else if (record.kind == cupti_kernel) {
        const auto& kernel = reinterpret_cast<const CuptiKernel&>(record);
        add_span(kernel.correlation, kernel.start, kernel.end);
    } else if (record.kind == cupti_memcpy || record.kind == cupti_memset) {
        const auto& transfer = reinterpret_cast<const CuptiTransfer&>(record);
        add_span(transfer.correlation, transfer.start, transfer.end);
    }
}

/// One call may have several records, for example a copy in parts.
void Activity::add_span(std::uint32_t correlation, std::uint64_t start, std::uint64_t end) {
    if (start == 0 || end < start) return; // CUPTI has no valid times
    auto& span = gathered_[correlation].span;
    span = merged(span, {static_cast<std::int64_t>(start), static_cast<std::int64_t>(end)});
}

/// Records of other commands, of the application or another profiler, stay until no command of ours is
/// outstanding; take() then deletes them.
void Activity::collect() {
    done(cupti_->cuptiActivityFlushAll(0), "cuptiActivityFlushAll");
    const std::lock_guard lock(mutex_);
    std::erase_if(gathered_, [&](const auto& entry) {
        const auto& [command, span] = entry.second;
        if (command == 0 || !span) return false;
        const auto known = spans_.find(command);
        spans_[command] = merged(known == spans_.end() ? std::nullopt : std::optional(known->second), *span);
        return true;
    });
}

std::optional<Activity::Span> Activity::take(std::uint64_t id) {
    if (id == 0) return std::nullopt;
    const std::lock_guard lock(mutex_);
    if (--outstanding_ == 0) gathered_.clear();
    const auto found = spans_.extract(id);
    if (found.empty()) return std::nullopt;
    return found.mapped();
}

Activity& activity(int driver_version) {
    // Never destroyed: a thread of CUPTI may call back until the process ends.
    static auto* const one = new Activity(cupti_candidates(driver_version));
    return *one;
}

} // namespace tandem::cuda
