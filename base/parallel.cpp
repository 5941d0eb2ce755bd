// SPDX-License-Identifier: MIT
#include "base/parallel.h"

#include "base/fork_join.h"

#include <optional>
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace tandem {

std::size_t usable_cores() { return static_cast<std::size_t>(tbb::info::default_concurrency()); }

void parallel_for(std::size_t count, std::size_t threads, const std::function<void(std::size_t)>& work) {
    threads = std::min(count, threads);
    if (threads <= 1) {
        for (std::size_t i = 0; i < count; ++i) work(i);
        return;
    }
    // oneTBB starts at most as many threads as there are cores, unless it is asked for more.
    std::optional<tbb::global_control> more;
    if (threads > usable_cores()) more.emplace(tbb::global_control::max_allowed_parallelism, threads);
    using Items = tbb::blocked_range<std::size_t>;
    ForkJoin edges;
    const auto body = [&](const Items& items) {
        const ForkJoin::Part part(edges);
        for (auto i = items.begin(); i != items.end(); ++i) work(i);
    };
    tbb::task_arena arena(static_cast<int>(threads));
    arena.execute(
        [&] { tbb::parallel_for(Items(0, count, 1), SynchronizedWork(body), tbb::simple_partitioner()); });
}

void parallel_for(std::size_t count, const std::function<void(std::size_t)>& work) {
    parallel_for(count, usable_cores(), work);
}

} // namespace tandem
