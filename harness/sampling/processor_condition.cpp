// SPDX-License-Identifier: MIT
#include "harness/sampling/processor_condition.h"

#include "harness/sampling/control_group.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <sched.h>
#include <span>
#include <sstream>
#include <sys/resource.h>
#include <unistd.h>
#include <utility>

namespace tandem {

namespace {

/// Clock ticks of one core since the machine started: man 5 proc, /proc/stat.
struct Ticks {
    double all = 0;
    double busy = 0; ///< neither idle nor waiting for a disk; includes time stolen by other virtual machines
};

/// Parses a line "cpuN user nice system idle iowait irq softirq steal ...". Later columns are ignored: user
/// and nice already include them.
std::optional<std::pair<unsigned, Ticks>> ticks_in(const std::string& line) {
    std::istringstream words(line);
    std::string name;
    words >> name;
    if (!name.starts_with("cpu") || name.size() == 3) return std::nullopt;
    Ticks ticks;
    unsigned columns = 0;
    for (double value = 0; columns < 8 && words >> value; ++columns) {
        ticks.all += value;
        if (columns != 3 && columns != 4) ticks.busy += value;
    }
    unsigned core = 0;
    if (columns < 4 || !(std::istringstream(name.substr(3)) >> core)) return std::nullopt;
    return std::pair{core, ticks};
}

bool is_among(std::span<const unsigned> cores, unsigned core) {
    return std::find(cores.begin(), cores.end(), core) != cores.end();
}

/// The first word of a core's file under cpufreq; empty when there is none.
std::string frequency_word(const std::string& root, unsigned core, std::string_view file) {
    std::ifstream in(fmt::format("{}/sys/devices/system/cpu/cpu{}/cpufreq/{}", root, core, file));
    std::string word;
    in >> word;
    return word;
}

std::optional<std::string> governor_of(const std::string& root, std::span<const unsigned> cores) {
    std::optional<std::string> governor;
    for (const auto core : cores) {
        const auto word = frequency_word(root, core, "scaling_governor");
        if (word.empty()) continue;
        if (governor && *governor != word) return "mixed";
        governor = word;
    }
    return governor;
}

/// "cpu MHz" of the given cores in /proc/cpuinfo, in the order of the file.
std::vector<double> cpuinfo_mhz(const std::string& root, std::span<const unsigned> cores) {
    std::ifstream file(root + "/proc/cpuinfo");
    std::vector<double> clocks;
    bool is_listed = false;
    for (std::string line; clocks.size() < cores.size() && std::getline(file, line);) {
        double value = 0;
        const auto colon = line.find(':');
        if (colon == std::string::npos || !(std::istringstream(line.substr(colon + 1)) >> value)) continue;
        if (line.starts_with("processor"))
            is_listed = value >= 0 && value < 1e6 && is_among(cores, static_cast<unsigned>(value));
        if (is_listed && line.starts_with("cpu MHz")) clocks.push_back(value);
    }
    return clocks;
}

std::optional<double> mhz_of(const std::string& root, std::span<const unsigned> cores) {
    std::vector<double> clocks;
    for (const auto core : cores) {
        double khz = 0;
        if (std::istringstream(frequency_word(root, core, "scaling_cur_freq")) >> khz)
            clocks.push_back(khz / 1e3);
    }
    if (clocks.empty()) clocks = cpuinfo_mhz(root, cores);
    double sum = 0;
    for (const auto mhz : clocks) sum += mhz;
    if (sum <= 0) return std::nullopt;
    return sum / static_cast<double>(clocks.size());
}

/// Parses "some avg10=0.12 ...", which the kernel's documentation of pressure stall information defines.
std::optional<double> pressure_of(const std::string& root) {
    std::ifstream file(root + "/proc/pressure/cpu");
    std::string some, average;
    constexpr std::string_view begin = "avg10=";
    double percent = 0;
    if (!(file >> some >> average) || some != "some" || !average.starts_with(begin)
        || !(std::istringstream(average.substr(begin.size())) >> percent))
        return std::nullopt;
    return percent;
}

/// Empty when a core is unknown.
std::optional<ProcessorLoad> load(const std::string& root, const OwnUse& use) {
    const auto per_second = static_cast<double>(sysconf(_SC_CLK_TCK));
    ProcessorLoad sum{.cores = use.cores, .own = use.seconds};
    std::size_t found = 0;
    std::ifstream file(root + "/proc/stat");
    for (std::string line; std::getline(file, line) && line.starts_with("cpu");) {
        const auto core = ticks_in(line);
        if (!core || !is_among(use.cores, core->first)) continue;
        ++found;
        sum.busy += core->second.busy / per_second;
        sum.elapsed += core->second.all / per_second / static_cast<double>(use.cores.size());
    }
    if (found == 0 || found != use.cores.size()) return std::nullopt;
    return sum;
}

ProcessorLoad left_out; ///< by ProcessorReader::leave_out

} // namespace

OwnUse own_use() {
    OwnUse use;
    cpu_set_t set;
    CPU_ZERO(&set);
    // The call fails on machines with more cores than the set can contain: the cores stay unknown.
    if (sched_getaffinity(0, sizeof(set), &set) == 0)
        for (unsigned core = 0; core < CPU_SETSIZE; ++core)
            if (CPU_ISSET(core, &set)) use.cores.push_back(core);
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    for (const auto& time : {usage.ru_utime, usage.ru_stime})
        use.seconds += static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
    return use;
}

ProcessorReader::ProcessorReader(std::string root, std::function<OwnUse()> own)
    : root_(std::move(root)), own_use_(std::move(own)) {
    update_load(own_use_());
    update_throttled(read_control_group(root_).throttled);
}

void ProcessorReader::leave_out(const std::function<void()>& wait, const std::string& root,
                                const std::function<OwnUse()>& own) {
    const auto before = load(root, own());
    wait();
    const auto after = load(root, own());
    if (!before || !after || before->cores != after->cores) return;
    left_out.elapsed += after->elapsed - before->elapsed;
    left_out.busy += after->busy - before->busy;
    left_out.own += after->own - before->own;
}

void ProcessorReader::update_load(const OwnUse& use) {
    auto now = load(root_, use);
    if (now) {
        now->elapsed -= left_out.elapsed;
        now->busy -= left_out.busy;
        now->own -= left_out.own;
    }
    if (!now || !base_ || now->cores != base_->cores || now->elapsed < base_->elapsed) {
        own_ = other_processes_ = std::nullopt;
        base_ = std::move(now);
        return;
    }
    const auto period = now->elapsed - base_->elapsed;
    if (period < shortest_period) return;
    own_ = (now->own - base_->own) / period;
    other_processes_ = std::max(0.0, (now->busy - base_->busy) / period - *own_);
    base_ = std::move(now);
}

/// The count can decrease when this process moves to another control group.
std::optional<std::uint64_t> ProcessorReader::update_throttled(std::optional<std::uint64_t> now) {
    const auto before = std::exchange(throttled_, now);
    if (!now || !before) return std::nullopt;
    return *now - std::min(*now, *before);
}

ProcessorCondition ProcessorReader::read() {
    const auto use = own_use_();
    update_load(use);
    const auto group = read_control_group(root_);
    const auto sampled =
        std::span(use.cores).first(std::min<std::size_t>(use.cores.size(), most_sampled_cores));
    return {.cores = static_cast<unsigned>(use.cores.size()),
            .quota = group.cores,
            .own = own_,
            .other_processes = other_processes_,
            .governor = governor_of(root_, sampled),
            .mhz = mhz_of(root_, sampled),
            .throttled = update_throttled(group.throttled),
            .pressure = pressure_of(root_)};
}

} // namespace tandem
