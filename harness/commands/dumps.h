// SPDX-License-Identifier: MIT
#pragma once

#include "harness/commands/dump_file.h"
#include "harness/plans/task.h"
#include "harness/profile/timeline/timeline.h"

namespace tandem {

/// The files of --dump-pairs, --dump-contacts, --dump-distances, --dump-surfaces and --trace, which have the
/// answer and the timeline of one cell.
class Dumps {
public:
    /// Makes sure that the files can be written. Without `writes`, as on all ranks but the first, the other
    /// calls take part but write nothing. Throws InputError.
    Dumps(const RunOptions& options, bool writes);

    /// Replays the frames of the cell for the dumps, because writing files takes longer than running frames,
    /// and runs the middle frame for the timeline. Collective. Throws OutputError, Interrupted and
    /// DeviceError.
    void write(const Cell& cell, const Task& task);

private:
    void dump(const Cell& cell, const Task& task);

    DumpFile pairs_, contacts_, distances_;
    WholeFile surfaces_; ///< written at the end, because a .vtp file begins with the number of its polygons
    TimelineFile trace_;
};

} // namespace tandem
