// SPDX-License-Identifier: MIT
#pragma once

#include "backends/ranks.h"

#include <barrier>
#include <cstdlib>
#include <thread>

namespace tandem::support {

/// Ranks that are threads of this process: the collective calls of Ranks without MPI. Each call copies from
/// the memory of the other threads between two barriers.
class ThreadJob {
public:
    explicit ThreadJob(std::size_t size) : arguments_(size), barrier_(static_cast<std::ptrdiff_t>(size)) {}

    /// Calls `work` with the ranks of this job, each on its own thread; returns when all of them have
    /// returned. An exception terminates the process because the remaining ranks would wait forever.
    template<class Work>
    void run(const Work& work) {
        std::vector<std::jthread> threads;
        for (std::size_t i = 0; i < arguments_.size(); ++i)
            threads.emplace_back([this, i, &work]() noexcept {
                ThreadRank ranks(*this, static_cast<int>(i));
                work(ranks);
            });
    }

private:
    class ThreadRank final : public Ranks {
    public:
        ThreadRank(ThreadJob& job, int rank) : job_(job), rank_(rank) {}

        int rank() const override { return rank_; }
        int size() const override { return static_cast<int>(job_.arguments_.size()); }
        void broadcast(Bytes& bytes, int from) override {
            publish(&bytes);
            if (rank_ != from) bytes = *argument<Bytes>(static_cast<std::size_t>(from));
            wait();
        }
        std::vector<Bytes> gather_to_all(std::span<const std::byte> own) override {
            publish(&own);
            std::vector<Bytes> all(job_.arguments_.size());
            for (std::size_t i = 0; i < all.size(); ++i) {
                const auto& one = *argument<std::span<const std::byte>>(i);
                all[i].assign(one.begin(), one.end());
            }
            wait();
            return all;
        }
        std::vector<Bytes> exchange(const std::vector<Bytes>& out) override {
            publish(&out);
            std::vector<Bytes> in(out.size());
            for (std::size_t i = 0; i < in.size(); ++i)
                in[i] = (*argument<std::vector<Bytes>>(i))[static_cast<std::size_t>(rank_)];
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
        void publish(const void* bytes) {
            job_.arguments_[static_cast<std::size_t>(rank_)] = bytes;
            wait();
        }
        template<class Argument>
        const Argument* argument(std::size_t from) const {
            return static_cast<const Argument*>(job_.arguments_[from]);
        }

        ThreadJob& job_;
        int rank_;
    };

    std::vector<const void*> arguments_; ///< by rank, valid between the barriers of a call
    std::barrier<> barrier_;
};

} // namespace tandem::support
