// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

namespace tandem {

/// The result of a request to a child process.
struct ChildResult {
    std::string output;   ///< of the process, up to the end of its answer
    std::string failure;  ///< "ended by signal 11 (Segmentation fault)"; empty after an answer or exit code 0
    bool stopped = false; ///< killed because `stop` returned true
};

/// Ends an answer on a child's standard output. Text that libraries print does not contain this byte.
constexpr char end_of_answer = '\x1e';

/// Runs this program with other arguments as a child process, outside any MPI job. The child shares standard
/// error and has its own process group, so that it does not receive signals of a terminal.
class ChildProcess {
public:
    /// Starts the process. Throws OutputError when that fails.
    explicit ChildProcess(std::span<const std::string> arguments);
    /// Closes its input, waits for its end, and kills it after 10 s.
    ~ChildProcess();

    /// Writes a line to its standard input and waits for the end of its answer. Kills it after `seconds` (0:
    /// no limit), or once `stop` returns true, which is called twenty times a second. After a request without
    /// an answer the process has ended: do not call ask() again.
    ChildResult ask(
        const std::string& line, double seconds, const std::function<bool()>& stop = [] { return false; });
    bool has_ended() const;

    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    class Descriptor;

private:
    struct Running;
    std::unique_ptr<Running> running_; ///< null when the process has ended
};

/// Called by the child: kills it when its parent ends.
void end_with_parent();

} // namespace tandem
