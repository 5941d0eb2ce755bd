// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

#include <barrier>
#include <cstdlib>
#include <thread>

namespace tandem::testing_support {

/// Ranks that are threads of this process: what Ranks asks of all of them together, without MPI. Each call
/// copies from the memory of the others between two barriers.
class ThreadJob {
public:
    explicit ThreadJob(std::size_t size) : given_(size), barrier_(static_cast<std::ptrdiff_t>(size)) {}

    /// Calls `work` with the ranks of this job, each on a thread of its own; returns when all have ended. An
    /// exception ends the process: the others would wait for ever.
    template<class Work>
    void run(const Work& work) {
        std::vector<std::jthread> threads;
        for (std::size_t i = 0; i < given_.size(); ++i)
            threads.emplace_back([this, i, &work]() noexcept {
                Member ranks(*this, static_cast<int>(i));
                work(ranks);
            });
    }

private:
    class Member final : public Ranks {
    public:
        Member(ThreadJob& job, int rank) : job_(job), rank_(rank) {}

        int rank() const override { return rank_; }
        int size() const override { return static_cast<int>(job_.given_.size()); }
        void broadcast(Bytes& bytes, int from) override {
            give(&bytes);
            if (rank_ != from) bytes = *taken<Bytes>(static_cast<std::size_t>(from));
            wait();
        }
        std::vector<Bytes> gather_to_all(std::span<const std::byte> own) override {
            give(&own);
            std::vector<Bytes> all(job_.given_.size());
            for (std::size_t i = 0; i < all.size(); ++i) {
                const auto& one = *taken<std::span<const std::byte>>(i);
                all[i].assign(one.begin(), one.end());
            }
            wait();
            return all;
        }
        std::vector<Bytes> exchange(const std::vector<Bytes>& out) override {
            give(&out);
            std::vector<Bytes> in(out.size());
            for (std::size_t i = 0; i < in.size(); ++i)
                in[i] = (*taken<std::vector<Bytes>>(i))[static_cast<std::size_t>(rank_)];
            wait();
            return in;
        }
        bool is_gpu_aware(const DeviceInfo&) const override { return false; }
        void exchange_device(std::span<const Piece>, std::span<const Piece>) override { refuse(); }
        void send(int, std::span<const std::byte>) override { refuse(); }
        Received receive() override { refuse(); }
        bool probe() override { return false; }
        void abort(int code) override { std::_Exit(code); }

    private:
        [[noreturn]] static void refuse() { throw RanksError("threads pass no such messages"); }
        void wait() { job_.barrier_.arrive_and_wait(); }
        void give(const void* bytes) {
            job_.given_[static_cast<std::size_t>(rank_)] = bytes;
            wait();
        }
        template<class What>
        const What* taken(std::size_t from) const {
            return static_cast<const What*>(job_.given_[from]);
        }

        ThreadJob& job_;
        int rank_;
    };

    std::vector<const void*> given_; ///< by rank, between the barriers of a call
    std::barrier<> barrier_;
};

} // namespace tandem::testing_support
