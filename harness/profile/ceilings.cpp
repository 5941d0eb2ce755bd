// SPDX-License-Identifier: MIT
#include "harness/profile/ceilings.h"

#include "algorithms/hierarchy/ceilings.cl.h"
#include "algorithms/bounds/geometry.h"
#include "algorithms/kernels/sources.h"
#include "harness/record/record.h"
#include "base/statistics.h"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace tandem {

namespace {

using Clock = std::chrono::steady_clock;
using Samples = std::vector<double>;

constexpr int repeats = 9;

/// The measurements on one device, with its buffer sizes. Large buffers exceed every cache, small ones fit
/// the second-level cache of every GPU. Work-items of a processor move pages, alone in their groups.
class Bench {
public:
    explicit Bench(Device& device)
        : device_(device),
          wide_(std::min(256u, device.info().max_group_size)),
          group_(device.info().is_gpu ? wide_ : 1),
          groups_(device.info().is_gpu ? device.info().compute_units * 8 : device.info().compute_units * 4),
          large_(fitted(device.info().is_gpu ? std::size_t{2} << 30 : std::size_t{256} << 20)),
          small_(fitted(cached_bytes(device.info()))) {}

    Ceilings run();

private:
    using Nothing = KernelOf<kernels::ceilings::DoNothing>;

    /// Rounds down to whole rounds of the grid, in which each work-item moves 8 words of 8 bytes; alone in
    /// its group, 512.
    std::size_t fitted(std::size_t bytes) const {
        const std::size_t round = std::size_t{groups_} * group_ * (group_ == 1 ? 4096 : 64);
        return std::max<std::size_t>(1,
                                     std::min<std::size_t>(bytes, device_.info().max_allocation / 4) / round)
               * round;
    }
    /// Only the overlap test depends on k.
    template<class Arguments>
    KernelOf<Arguments> compiled(std::uint32_t group, int k = 18) {
        KernelOf<Arguments> kernel;
        compile_kernel(device_, kernel, geometry_defines({.k = k}, group));
        return kernel;
    }
    template<class Arguments>
    void launch(const KernelOf<Arguments>& kernel, const std::type_identity_t<Arguments>& arguments) {
        device_.launch(kernel, {groups_, group_}, arguments);
    }
    template<class Work>
    Samples per_second(double amount, const Work& work);
    template<class Work>
    Samples seconds(double count, const Work& work);
    Samples timed_launch(const Nothing& nothing, const Buffer& buffer);
    Samples overlaps(int k);
    Samples upload_pinned(const Buffer& buffer, std::span<const std::byte> bytes);

    Device& device_;
    std::uint32_t wide_;  ///< work-items of a group that computes
    std::uint32_t group_; ///< of one that moves memory
    std::uint32_t groups_;
    std::size_t large_;
    std::size_t small_;
};

/// Host seconds of `work` and the wait for it, divided by `count`. Runs once to warm up, then `repeats`
/// times.
template<class Work>
Samples Bench::seconds(double count, const Work& work) {
    Samples samples;
    for (int i = -1; i < repeats; ++i) {
        device_.finish();
        const auto begin = Clock::now();
        work();
        device_.finish();
        const std::chrono::duration<double> span = Clock::now() - begin;
        if (i >= 0) samples.push_back(span.count() / count);
    }
    return samples;
}

/// `amount` divided by the device time of the one command of `work`. Empty when the device reports no times.
template<class Work>
Samples Bench::per_second(double amount, const Work& work) {
    device_.set_clocks(Clocks::on);
    Samples samples;
    for (int i = -1; i < repeats; ++i) {
        device_.finish();
        work();
        for (const auto& event : device_.finish().events)
            if (event.ticket != 0 && event.device_ns > 0 && i >= 0)
                samples.push_back(amount * 1e9 / static_cast<double>(event.device_ns));
    }
    device_.set_clocks(Clocks::off);
    return samples;
}

/// Overlap tests a second. Every work-item tests boxes in its registers, `rounds` times in a row, so that
/// memory does not limit the rate; on device host, boxes in all lanes of its vectors. A processor does a
/// twentieth of the turns, to take about the same time.
Samples Bench::overlaps(int k) {
    constexpr std::uint32_t most = 2000;
    const auto nodes = device_.allocate(static_cast<std::size_t>(k) * 8, "nodes");
    const auto counts = device_.allocate(std::size_t{groups_} * wide_ * 4, "counts");
    std::vector<float> slabs(static_cast<std::size_t>(k) * 2, 0.0f);
    device_.upload(nodes, bytes_of(slabs));
    const auto elements = device_.allocate(4, "elements");
    const std::uint32_t rounds = device_.info().is_gpu ? most : most / 20;
    const int axes = k / 2;
    const auto kernel = compiled<kernels::ceilings::TestOverlaps>(wide_, k);
    const auto test = [&] {
        device_.launch(
            kernel, {groups_, wide_},
            {.nodes = nodes, .counts = counts, .elements = elements, .rounds = rounds, .turns = 1u});
    };
    test();
    std::uint32_t pack = 0;
    device_.download(elements, std::as_writable_bytes(std::span(&pack, 1)));
    return per_second(static_cast<double>(groups_) * wide_ * pack * rounds * axes, test);
}

/// Uses device times, because the host only copies to page-locked memory and does not wait for the transfer.
Samples Bench::upload_pinned(const Buffer& buffer, std::span<const std::byte> bytes) {
    if (!device_.info().stages_pinned) return {};
    return per_second(static_cast<double>(bytes.size()), [&] { device_.upload(buffer, bytes); });
}

/// Device seconds of an empty launch that is timed alone: the time of any kernel is at least as long.
Samples Bench::timed_launch(const Nothing& nothing, const Buffer& buffer) {
    auto samples = per_second(1, [&] { device_.launch(nothing, {1, wide_}, {.out = buffer}); });
    for (auto& s : samples) s = 1 / s;
    return samples;
}

Ceilings Bench::run() {
    const StageScope scope(device_, Stage::traverse); // a trace needs a stage; which one does not matter here
    Ceilings c;
    const auto from = device_.allocate(large_, "source");
    const auto to = device_.allocate(large_, "target");
    const auto words = static_cast<std::uint64_t>(large_ / 8);
    device_.clear(from, large_);
    const auto copy = compiled<kernels::ceilings::CopyWords>(group_);
    const auto read = compiled<kernels::ceilings::ReadWords>(group_);
    c.copy = per_second(2.0 * static_cast<double>(large_),
                        [&] { launch(copy, {.from = from, .to = to, .words = words}); });
    const kernels::ceilings::ReadWords once{.from = from, .out = to, .words = words, .rounds = 1u};
    c.read = per_second(static_cast<double>(large_), [&] { launch(read, once); });
    constexpr std::uint32_t rounds = 64;
    const kernels::ceilings::ReadWords cached{
        .from = from, .out = to, .words = std::uint64_t{small_ / 8}, .rounds = rounds};
    c.cache_read = per_second(static_cast<double>(small_) * rounds, [&] { launch(read, cached); });

    std::vector<std::byte> bytes(std::min<std::size_t>(large_, std::size_t{64} << 20), std::byte{1});
    const auto size = static_cast<double>(bytes.size());
    const auto rate = [&](Samples samples) {
        for (auto& s : samples) s = size / s;
        return samples;
    };
    c.upload_pinned = upload_pinned(to, bytes);
    c.upload_pageable = rate(seconds(1, [&] { device_.upload(to, bytes, 0, true); }));
    c.download = rate(seconds(1, [&] { device_.download(to, bytes); }));

    const auto nothing = compiled<kernels::ceilings::DoNothing>(wide_);
    const auto submit = [&] { device_.launch(nothing, {1, wide_}, {.out = to}); };
    c.launch = seconds(1, submit);
    constexpr int many = 1000;
    c.launch_queued = seconds(many, [&] {
        for (int i = 0; i < many; ++i) submit();
    });
    c.launch_timed = timed_launch(nothing, to);
    c.overlaps8 = overlaps(8);
    c.overlaps18 = overlaps(18);
    return c;
}

struct CeilingRow {
    const char* name;
    const char* text;
    const Samples Ceilings::*samples;
    double scale;
    const char* unit;
};

constexpr CeilingRow rows[] = {
    {"copy_bytes_per_s", "copy in device memory, read and written", &Ceilings::copy, 1e-9, "GB/s"},
    {"read_bytes_per_s", "read of device memory", &Ceilings::read, 1e-9, "GB/s"},
    {"cache_read_bytes_per_s", "read from the cache", &Ceilings::cache_read, 1e-9, "GB/s"},
    {"upload_pinned_bytes_per_s", "upload, page-locked", &Ceilings::upload_pinned, 1e-9, "GB/s"},
    {"upload_pageable_bytes_per_s", "upload, pageable", &Ceilings::upload_pageable, 1e-9, "GB/s"},
    {"download_pageable_bytes_per_s", "download, pageable", &Ceilings::download, 1e-9, "GB/s"},
    {"launch_s", "launch and wait", &Ceilings::launch, 1e6, "us"},
    {"launch_queued_s", "launch, one of many in a row", &Ceilings::launch_queued, 1e6, "us"},
    {"launch_timed_s", "launch, by the device's clock", &Ceilings::launch_timed, 1e6, "us"},
    {"overlap_tests_k8_per_s", "overlap tests from registers, k = 8", &Ceilings::overlaps8, 1e-9, "G/s"},
    {"overlap_tests_k18_per_s", "overlap tests from registers, k = 18", &Ceilings::overlaps18, 1e-9, "G/s"},
};

/// Null for 0, which means unknown.
nlohmann::ordered_json known(std::uint64_t number) {
    return number == 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(number);
}

/// The numbers that the driver reports, as opposed to the measured ones.
nlohmann::ordered_json reported_json(const DeviceInfo& info) {
    nlohmann::ordered_json json{{"cores", known(info.cores)},
                                {"clock_mhz", known(info.clock_mhz)},
                                {"local_bytes", known(info.local_bytes)},
                                {"peak_bytes_per_s", known(info.peak_bytes_per_s)},
                                {"peak_flops", nullptr}};
    if (info.cores != 0 && info.clock_mhz != 0) json["peak_flops"] = 2e6 * info.cores * info.clock_mhz;
    return json;
}

} // namespace

std::size_t cached_bytes(const DeviceInfo& info) {
    return info.is_gpu ? std::size_t{16} << 20 : std::size_t{1} << 20;
}

Ceilings measure_ceilings(Device& device) { return Bench(device).run(); }

nlohmann::ordered_json ceilings_record(const Device& device, const Ceilings& ceilings) {
    nlohmann::ordered_json json{{"schema", 1}, {"device", record_timed_device(device)}};
    for (const auto& row : rows) {
        const auto& samples = ceilings.*row.samples;
        json[row.name] = samples.empty()
                             ? nlohmann::ordered_json()
                             : nlohmann::ordered_json{{"median", median(samples)}, {"samples", samples}};
    }
    json["told"] = reported_json(device.info());
    json["environment"] = record_environment();
    return json;
}

std::string ceilings_table(const DeviceInfo& info, const Ceilings& ceilings) {
    std::string text = fmt::format("{} ({})\n", info.id, info.name);
    for (const auto& row : rows) {
        const auto& samples = ceilings.*row.samples;
        text += samples.empty() ? fmt::format("    {:<42} not known\n", row.text)
                                : fmt::format("    {:<42} {:>10.4g} {}\n", row.text,
                                              median(samples) * row.scale, row.unit);
    }
    return text;
}

} // namespace tandem
