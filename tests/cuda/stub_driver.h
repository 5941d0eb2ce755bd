// SPDX-License-Identifier: MIT
// What the stub of the driver tells a test beside what a driver does; looked up by name, since only a stub
// has it.
#pragma once

struct CUctx_st;
struct CUstream_st;

extern "C" {
/// The calls so far that name this stream, made while this context was current.
unsigned long stub_calls(CUstream_st* stream, CUctx_st* context);
/// The calls so far that name any stream.
unsigned long stub_all_calls();
/// Those of them that wait for one.
unsigned long stub_waits();
/// Graphs that live; how often one was launched; and of how many commands these were.
unsigned long stub_graphs();
unsigned long stub_graph_launches();
unsigned long stub_commands_in_graphs();
/// How often an event was recorded.
unsigned long stub_event_records();
/// How often what `stream` is given next had to wait for what `before` was given so far.
unsigned long stub_orderings(CUstream_st* stream, CUstream_st* before);
/// From here on `watcher` is called at every command that a stream is told, with its kind as CUPTI numbers it
/// (1 copy, 2 clear, 10 kernel); null: no longer.
void stub_watch(void (*watcher)(int kind));
/// Launches so far one of whose arguments is this address, and copies so far to or from it.
unsigned long stub_launches_with(unsigned long long address);
unsigned long stub_copies_of(unsigned long long address);
/// How often a profiler was told to begin and to end.
unsigned long stub_profiler_starts();
unsigned long stub_profiler_stops();
}
