// SPDX-License-Identifier: MIT
// Queries of the driver stub; tests look them up by name because only the stub exports them.
#pragma once

struct CUctx_st;
struct CUstream_st;

extern "C" {
/// Number of calls with this stream while this context was current.
unsigned long stub_calls(CUstream_st* stream, CUctx_st* context);
/// Number of calls with any stream.
unsigned long stub_all_calls();
/// Number of those that wait for a stream.
unsigned long stub_waits();
/// Live graphs, launches of graphs, and commands in the launched graphs.
unsigned long stub_graphs();
unsigned long stub_graph_launches();
unsigned long stub_commands_in_graphs();
/// Number of recorded events.
unsigned long stub_event_records();
/// Number of times that later commands of `stream` were ordered after earlier commands of `before`.
unsigned long stub_orderings(CUstream_st* stream, CUstream_st* before);
/// Sets a function that is called for every command of a stream with its kind in CUPTI's numbering (1 copy, 2
/// clear, 10 kernel); null removes it.
void stub_watch(void (*watcher)(int kind));
/// Number of launches with this address among their arguments, and of copies to or from it.
unsigned long stub_launches_with(unsigned long long address);
unsigned long stub_copies_of(unsigned long long address);
/// Number of starts and stops of a profiler.
unsigned long stub_profiler_starts();
unsigned long stub_profiler_stops();
}
