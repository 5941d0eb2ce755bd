// SPDX-License-Identifier: MIT
// A profile as a table and as a record.
#pragma once

#include "harness/profile/kernels.h"

#include <nlohmann/json_fwd.hpp>

namespace tandem::profile {

/// The profile of a cell: its kernels, and the limits they are compared with.
struct Profile {
    std::vector<KernelProfile> kernels;
    FrameFacts facts;
    Limits limits;
    nlohmann::ordered_json const* ceilings = nullptr; ///< the record from which the limits come
    std::string ceilings_from;                        ///< "measured", or the file
};

/// A table of at most 100 columns with one row for each kernel, and the ceilings below it. Kernels below 1 %
/// of the device time share one row unless `all`.
std::string profile_table(const Profile& profile, bool all);

/// The meaning of the columns.
std::string profile_legend();

/// One object of results/profile.schema.json, made from the ordinary record of the same cell.
nlohmann::ordered_json profile_record(const nlohmann::ordered_json& record, const Profile& profile);

} // namespace tandem::profile
