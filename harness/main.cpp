// SPDX-License-Identifier: MIT
#include "harness/commands/options/command_line.h"
#include "base/files_in_use.h"
#include "base/memory_reserve.h"
#include "harness/program/mpi_environment.h"
#include "harness/program/run_on_ranks.h"
#include "base/standard_streams.h"
#include "base/text_lines.h"
#include "base/error.h"

#include <algorithm>
#include <functional>
#include <new>

namespace {

using tandem::InputError;

/// Runs `work` and turns exceptions into exit codes: 0 ok, 1 a check failed (the command returns it), 2 bad
/// use or bad input, 3 a device or the machine failed. No std::function: it allocates, and memory may be
/// short.
template<class Work>
int guarded(const Work& work) {
    try {
        return work();
    } catch (const InputError& error) {
        tandem::print_message("tandem: {}\n", tandem::visible(error.what()));
        return 2;
    } catch (const std::bad_alloc&) {
        tandem::print_message("tandem: out of memory; use fewer bodies or frames\n");
        return 3;
    } catch (const std::exception& error) {
        tandem::print_message("tandem: {}\n", tandem::visible(error.what()));
        return 3;
    }
}

int run(int argc, char** argv) {
    const auto read = [=] { return tandem::read_command_line(argc, argv); };
    return guarded([&] {
        const tandem::MemoryReserve reserve;
        const tandem::FilesInUse files;
        const tandem::MpiEnvironment mpi_environment;
        auto* ranks = tandem::job_ranks();
        if (ranks == nullptr) return guarded([&] { return read()(); });
        return tandem::run_on_ranks(*ranks, {argv + std::min(argc, 1), argv + argc}, read,
                                    [](const std::function<int()>& work) { return guarded(work); });
    });
}

} // namespace

/// Also returns 3 when standard output could not be written.
int main(int argc, char** argv) {
    tandem::prepare_standard_streams();
    return tandem::finish_output(run(argc, argv));
}
