// SPDX-License-Identifier: MIT
#pragma once

#include "harness/journal.h"
#include "harness/paper/steps.h"

#include <optional>
#include <set>
#include <string>

namespace tandem {

/// The folder of `tandem paper`: steps.jsonl says which steps have ended and how, records/, plans/ and logs/
/// have a file a step. Of one size and one device; another is refused.
class PaperFolder {
public:
    /// Makes what is not there. Throws InputError.
    PaperFolder(std::string path, const std::string& size, const std::string& device);

    /// Whether the step has ended well before, with the same command.
    bool is_done(const PaperStep& step) const;
    /// Does the step in a process of its own and says in steps.jsonl how it ended. Returns its exit code, or
    /// 128 and the signal that ended it. Throws OutputError.
    int run(const PaperStep& step);
    /// The last line that the step has printed; empty when there is none.
    std::string last_line(const PaperStep& step) const;
    /// Forgets a step and its records.
    void forget(const PaperStep& step);
    const std::string& path() const { return path_; }

private:
    std::string log_of(const PaperStep& step) const { return path_ + "/logs/" + step.name + ".txt"; }
    void write_plan(const PaperStep& step) const;
    void read_steps();

    std::string path_, size_, device_;
    std::optional<RecordFile> journal_;
    std::set<std::string> done_; ///< commands
};

} // namespace tandem
