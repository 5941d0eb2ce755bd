// SPDX-License-Identifier: MIT
#include "harness/commands/dumps.h"

#include "harness/plans/cell_session.h"
#include "harness/plans/rank_team.h"
#include "harness/profile/timeline/trace_frame.h"
#include "harness/program/interrupt.h"
#include "harness/verify/contact_surfaces.h"
#include "scenes/export/surfaces.h"

namespace tandem {

Dumps::Dumps(const RunOptions& options, bool writes)
    : pairs_(writes ? options.dump_pairs : std::string(), pairs_header),
      contacts_(writes ? options.dump_contacts : std::string(), ""),
      distances_(writes ? options.dump_distances : std::string(), ""),
      surfaces_(writes ? options.dump_surfaces : std::string()),
      trace_(writes ? options.trace : std::string()) {}

void Dumps::dump(const Cell& cell, const Task& task) {
    const auto session = prepare_session(cell, task.scene);
    const auto& settings = session->settings();
    const auto columns = row_columns(settings[parameters::contact_rule], settings[parameters::output]);
    contacts_.set_header(row_header(columns));
    distances_.set_header(row_header(columns));
    SurfaceFrames surfaces;
    const auto geometry = geometry_of(settings);
    for (std::size_t i = 0; i < task.range.size(); ++i) {
        if (decided(cell.team, Interrupt::asked())) throw Interrupted();
        const auto state = task.range.state(i, settings[parameters::motion]);
        const auto result = session->run(FrameView(state.input()).checked());
        // Collective: all ranks download; only rank 0 writes.
        if (!task.options.dump_pairs.empty())
            if (const auto found = result.download(); pairs_) pairs_.pairs(task.range.first() + i, found);
        auto& rows = task.options.dump_distances.empty() ? contacts_ : distances_;
        if (!task.options.dump_contacts.empty() || !task.options.dump_distances.empty())
            if (const auto found = result.download_contacts(); rows)
                rows.rows(task.range.first() + i, found, columns);
        if (!task.options.dump_surfaces.empty())
            if (const auto found = result.download_contacts(); surfaces_)
                surfaces.add(static_cast<std::uint32_t>(task.range.first() + i), found,
                             surfaces_of(task.scene, *task.range.frame(i), geometry, result.origin, found));
    }
    if (surfaces_) {
        surfaces_.write(surfaces_vtp(surfaces));
        surfaces_.finish();
    }
    pairs_.finish();
    distances_.finish();
    contacts_.finish();
}

void Dumps::write(const Cell& cell, const Task& task) {
    if (task.options.has_dumps()) dump(cell, task);
    if (!task.options.trace.empty()) trace_.write(trace_frame(cell, task));
}

} // namespace tandem
