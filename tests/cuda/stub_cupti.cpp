// SPDX-License-Identifier: MIT
// A libcupti.so that makes records of the commands of stub_driver.cpp: the n-th since the start of the
// process begins at 1,000,000 + 1,000 n ns and lasts 100 + n. As in CUPTI, it correlates external ids only
// while driver calls are recorded. Some of the records belong to other tools. Variables select faults:
// STUB_CUPTI_FAILS (name of a call that fails with 35, not permitted), STUB_CUPTI_LOSES (number of a command
// whose record is lost, or "all"), STUB_CUPTI_BACKWARDS (the last record comes first), STUB_CUPTI_VERSION.
#include "backends/cuda/cupti.h"
#include "tests/cuda/stub_cupti.h"
#include "tests/cuda/stub_driver.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <set>
#include <string_view>
#include <vector>

using namespace tandem::cuda;

namespace {

constexpr std::size_t record_stride = 128; ///< bytes between records, unknown to readers
constexpr std::size_t records_of_buffer = 3;

unsigned long calls = 0;
unsigned long commands = 0;
bool attached = false;
std::set<CuptiKind> enabled;
std::vector<std::uint64_t> ids; ///< pushed ids, the last one at the end
std::vector<std::array<unsigned char, record_stride>> records;
CuptiRequested requested = nullptr;
CuptiCompleted completed = nullptr;

std::string_view text(const char* name) {
    const auto* value = std::getenv(name);
    return value != nullptr ? value : "";
}

/// Return code of a call: 35 if it is to fail.
CuptiResult called(std::string_view name) {
    ++calls;
    return text("STUB_CUPTI_FAILS") == name ? 35 : 0;
}

template<class Record>
void add(const Record& record) {
    static_assert(sizeof(Record) <= record_stride);
    std::memcpy(records.emplace_back().data(), &record, sizeof(Record));
}

template<class Record>
void add_run(Record record, std::uint32_t correlation) {
    record.start = 1'000'000 + 1'000 * commands;
    record.end = record.start + 100 + commands;
    record.correlation = correlation;
    add(record);
}

/// Records of one command: another tool's kernel and correlation, our correlation, and its times.
void command(int kind) {
    ++commands;
    const auto correlation = static_cast<std::uint32_t>(2 * commands);
    CuptiKernel foreign;
    foreign.start = foreign.end = 5;
    foreign.correlation = correlation + 1;
    if (enabled.contains(cupti_kernel)) add(foreign);
    if (enabled.contains(cupti_external_correlation) && enabled.contains(cupti_driver) && !ids.empty()) {
        const auto other = static_cast<CuptiExternal>(cupti_custom + 1);
        add(CuptiCorrelation{.whose = other, .id = ids.back(), .correlation = correlation + 1});
        add(CuptiCorrelation{.id = ids.back(), .correlation = correlation});
    }
    const auto loses = text("STUB_CUPTI_LOSES");
    if (loses == "all" || loses == std::to_string(commands)
        || !enabled.contains(static_cast<CuptiKind>(kind)))
        return;
    if (kind == cupti_kernel)
        add_run(CuptiKernel{}, correlation);
    else
        add_run(CuptiTransfer{.kind = static_cast<CuptiKind>(kind)}, correlation);
}

void watch(void (*watcher)(int)) {
    auto* const driver = dlopen("libcuda.so.1", RTLD_NOW);
    reinterpret_cast<decltype(&stub_watch)>(dlsym(driver, "stub_watch"))(watcher);
}

/// Fills one buffer of the client with the first remaining records.
void deliver() {
    unsigned char* buffer = nullptr;
    std::size_t bytes = 0;
    std::size_t most = 0;
    requested(&buffer, &bytes, &most);
    const auto count = std::min(records.size(), records_of_buffer);
    std::memcpy(buffer, records.data(), count * record_stride);
    records.erase(records.begin(), records.begin() + static_cast<std::ptrdiff_t>(count));
    completed(nullptr, 0, buffer, bytes, count * record_stride);
}

} // namespace

extern "C" {
CuptiResult cuptiGetVersion(std::uint32_t* version) {
    const auto chosen = text("STUB_CUPTI_VERSION");
    *version = chosen.empty() ? 130001 : static_cast<std::uint32_t>(std::atoi(chosen.data()));
    return called(__func__);
}
CuptiResult cuptiSubscribe(CuptiSubscriber* subscriber, CuptiCallback, void*) {
    static char one;
    if (const auto code = called(__func__); code != 0) return code;
    if (attached) return 39; // CUPTI_ERROR_MULTIPLE_SUBSCRIBERS_NOT_SUPPORTED
    *subscriber = reinterpret_cast<CuptiSubscriber>(&one);
    attached = true;
    watch(command);
    return 0;
}
CuptiResult cuptiUnsubscribe(CuptiSubscriber) { return called(__func__); }
CuptiResult cuptiFinalize() {
    attached = false;
    watch(nullptr);
    return called(__func__);
}
CuptiResult cuptiActivityRegisterCallbacks(CuptiRequested on_request, CuptiCompleted on_completion) {
    requested = on_request;
    completed = on_completion;
    return called(__func__);
}
CuptiResult cuptiActivityEnable(CuptiKind kind) {
    const auto code = called(__func__);
    if (code == 0) enabled.insert(kind);
    return code;
}
CuptiResult cuptiActivityDisable(CuptiKind kind) {
    enabled.erase(kind);
    return called(__func__);
}
CuptiResult cuptiActivityFlushAll(std::uint32_t) {
    if (!text("STUB_CUPTI_BACKWARDS").empty()) std::reverse(records.begin(), records.end());
    while (!records.empty()) deliver();
    return called(__func__);
}
CuptiResult cuptiActivityGetNextRecord(unsigned char* buffer, std::size_t valid, CuptiRecord** record) {
    auto* const next =
        *record == nullptr ? buffer : reinterpret_cast<unsigned char*>(*record) + record_stride;
    if (next >= buffer + valid) return 12; // CUPTI_ERROR_MAX_LIMIT_REACHED
    *record = reinterpret_cast<CuptiRecord*>(next);
    return called(__func__);
}
CuptiResult cuptiActivityPushExternalCorrelationId(CuptiExternal, std::uint64_t id) {
    const auto code = called(__func__);
    if (code == 0) ids.push_back(id);
    return code;
}
CuptiResult cuptiActivityPopExternalCorrelationId(CuptiExternal, std::uint64_t*) {
    if (ids.empty()) return 18; // CUPTI_ERROR_QUEUE_EMPTY
    ids.pop_back();
    return called(__func__);
}

unsigned long stub_cupti_calls() { return calls; }
unsigned long stub_cupti_enabled() { return enabled.size(); }
bool stub_cupti_attached() { return attached; }
unsigned long stub_cupti_pushed() { return ids.size(); }
}
