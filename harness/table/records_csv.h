// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace tandem {

struct CsvTable {
    std::string text;
    std::size_t records = 0; ///< its lines but for that of names
};

/// The records of one file as a table of comma-separated values (RFC 4180): a line a record, of any status,
/// in their order, under one line of names. First what names and judges a cell, then times in milliseconds a
/// frame, then `stage_NAME_ms`, the median of a stage on the device (on the host where it has no time on a
/// device), `count_NAME`, an algorithm's counters, and `set_NAME`, its settings. Launches, waits, candidate
/// pairs, contacts and counters are sums over all frames. What a record does not have is empty. A last line
/// without an end is left out, and said on standard error. Throws InputError: FILE:LINE, what it is instead
/// and what to do.
CsvTable records_as_csv(const std::string& path);

} // namespace tandem
