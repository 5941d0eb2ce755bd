// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>

namespace tandem {

/// What became of a question.
struct ChildResult {
    std::string output;  ///< of the process, up to the end of its answer
    std::string failure; ///< "ended by signal 11 (Segmentation fault)"; empty behind an answer, or code 0
};

/// Ends an answer on a child's standard output: what libraries print there has no such byte.
constexpr char end_of_answer = '\x1e';

/// This program again with other arguments, in a process group of its own, so that signals of a terminal do
/// not reach it, outside of any job of MPI. It shares standard error.
class ChildProcess {
public:
    /// Starts it. Throws OutputError when no process can be made.
    explicit ChildProcess(std::span<const std::string> arguments);
    /// Lets it end, and kills it where it takes long.
    ~ChildProcess();

    /// Gives it a line on its standard input and waits for the end of its answer, `seconds` at most (0:
    /// without a limit), after which it is killed. Without an answer there is no more to be asked.
    ChildResult ask(const std::string& line, double seconds);
    bool is_over() const;

    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    class Descriptor;

private:
    struct Running;
    std::unique_ptr<Running> running_; ///< null when it is over
};

/// Called by the child: it ends when its parent does.
void end_with_parent();

} // namespace tandem
