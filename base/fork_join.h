// SPDX-License-Identifier: MIT
#pragma once

#if defined(__SANITIZE_THREAD__)
extern "C" void __tsan_acquire(void*);
extern "C" void __tsan_release(void*);
#endif

namespace tandem {

/// What comes before a parallel loop happens before its parts, and these before what comes after it. oneTBB
/// sees to that, but is not compiled with ThreadSanitizer, which has to be told; elsewhere this is nothing.
class ForkJoin {
public:
    ForkJoin() { release(&fork_); }
    ForkJoin(const ForkJoin&) = delete;
    ForkJoin& operator=(const ForkJoin&) = delete;
    ~ForkJoin() { acquire(&join_); }

    /// Around a part, on whatever thread.
    class Part {
    public:
        explicit Part(ForkJoin& all) : all_(all) { acquire(&all_.fork_); }
        Part(const Part&) = delete;
        Part& operator=(const Part&) = delete;
        ~Part() { release(&all_.join_); }

    private:
        ForkJoin& all_;
    };

private:
#if defined(__SANITIZE_THREAD__)
    static void acquire(void* edge) { __tsan_acquire(edge); }
    static void release(void* edge) { __tsan_release(edge); }
#else
    static void acquire(void*) {}
    static void release(void*) {}
#endif

    char fork_ = 0, join_ = 0;

    template<class Work>
    friend class SynchronizedWork;
};

/// What a parallel loop does, as oneTBB's tasks carry it from thread to thread: a copy is made by one, read
/// by another, and its memory taken for the next by a third, in order, which ThreadSanitizer has to be told
/// as well. `work` must outlive the loop.
template<class Work>
class SynchronizedWork {
public:
    explicit SynchronizedWork(const Work& work) : work_(&work) { ForkJoin::release(anchor_.edge()); }
    SynchronizedWork(const SynchronizedWork& other) : work_(other.received()) {
        ForkJoin::release(anchor_.edge());
    }
    SynchronizedWork& operator=(const SynchronizedWork&) = delete;

    template<class Range>
    void operator()(const Range& range) const {
        (*received())(range);
    }

private:
    /// The memory of a copy: taken before anything is written there, given up after everything is read. Its
    /// address is all there is of it.
    class Anchor {
    public:
        Anchor() { ForkJoin::acquire(edge()); }
        Anchor(const Anchor&) = delete;
        Anchor& operator=(const Anchor&) = delete;
        ~Anchor() { ForkJoin::release(edge()); }

        void* edge() const { return const_cast<Anchor*>(this); }
    };

    const Work* received() const {
        ForkJoin::acquire(anchor_.edge());
        return work_;
    }

    Anchor anchor_;
    const Work* work_;
};

} // namespace tandem
